#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <tuple>

#include "analysis/errors/error_summary.h"
#include "analysis/errors/uncertainty_quality.h"
#include "render/base/error.h"
#include "render/files/text_file.h"
#include "studies/case/case_files.h"
#include "studies/compare/budget_stages.h"
#include "studies/compare/comparison_kind.h"
#include "studies/compare/reconstruct_case.h"
#include "studies/figures/comparison_figures.h"
#include "studies/report/case_view.h"
#include "studies/report/density_section.h"
#include "studies/report/layout_view.h"
#include "studies/report/report.h"
#include "studies/sweep/job_array.h"

namespace gladstone::inline report {
namespace {

namespace fs = std::filesystem;

/// Adds maps of the displacements along the budget's chain and of the contribution of each cause.
void add_maps(CaseView& view) {
  Comparison const& all = view.comparison;
  std::vector<Vec2d> const& truth = all.point.displacement_px;
  view.add_map("measurement", all.measured.displacement_px);
  view.add_map("ray truth", truth);
  ComparisonKind const& kind = comparison_kind(all);
  for (ReferenceDisplacement const& one : kind.references) view.add_map(one.name, one.of(all));
  bool const estimated =
      std::any_of(all.measured.sigma_px.begin(), all.measured.sigma_px.end(),
                  [](Vec2d const& sigma) { return std::isfinite(sigma.x) || std::isfinite(sigma.y); });
  if (estimated) view.add_map("estimated uncertainty", all.measured.sigma_px);
  view.add_error("against ray truth", truth);
  view.add_error(kind.references.front().against, kind.references.front().of(all));
  view.add_error(std::string("against ") + all.recorded_name(), all.recorded().displacement_px);
  for (BudgetStage const& cause : budget_differences(all)) view.add_map("cause: " + cause.name, cause.displacement_px);
}

/// Returns the chart of rms errors in bins of equal count of the estimated uncertainty; nullopt below two bins.
std::optional<Chart> reliability_chart(Comparison const& all) {
  if (all.measured.sigma_px.empty()) return std::nullopt;
  std::vector<UncertaintyBin> const bins =
      uncertainty_bins(all.measured.displacement_px, all.recorded().displacement_px, all.measured.sigma_px, all.mask);
  if (bins.size() < 2) return std::nullopt;
  return Chart{"reliability",
               "Does the estimated uncertainty describe the error?",
               fmt::format("In {} bins of equal count the estimated uncertainty grows from {:.3g} to {:.3g} px, and "
                           "the rms error against "
                           "{} is {:.3g} px in the first and {:.3g} px in the last. On the dashed line they are equal.",
                           bins.size(), bins.front().rms_sigma_px, bins.back().rms_sigma_px, all.recorded_name(),
                           bins.front().rms_error_px, bins.back().rms_error_px),
               {{"", make_reliability_figure(bins)}}};
}

TextTable errors_table(CaseView const& view) {
  Comparison const& all = view.comparison;
  TextTable table{"Measured minus reference", {"measure"}, {}};
  std::vector<std::pair<std::string, std::vector<Vec2d> const*>> references{{"ray truth", &all.point.displacement_px}};
  for (ReferenceDisplacement const& one : comparison_kind(all).references)
    references.emplace_back(one.name, &one.of(all));
  references.emplace_back("truth on the window", &all.window.displacement_px);
  if (all.frames_deformed) references.emplace_back(all.recorded_name(), &all.recorded().displacement_px);
  for (auto const& [name, truth] : references) {
    table.header.push_back(name);
    auto const measures = error_measures(all.measured.displacement_px, *truth, all.mask, all.vectors_in_file());
    table.rows.resize(measures.size());
    for (std::size_t i = 0; i < measures.size(); ++i) {
      if (table.rows[i].empty()) table.rows[i].push_back({std::string(measures[i].first)});
      bool const displacement = measures[i].first.ends_with("_px");
      table.rows[i].push_back(displacement ? TableCell::px(measures[i].second) : TableCell::of(measures[i].second));
    }
  }
  return table;
}

/// Setup, frames and compared files of a case with their hashes, and the decoded frames.
struct CaseSources {
  SourceFiles files;
  FramePair<double> frames;
};

/// @throws DataError if a frame differs from that of the vectors
CaseSources read_case_sources(std::string const& folder, Comparison const& compared) {
  CaseSources read;
  SourceFiles& sources = read.files;
  sources.add("setup", in_case(folder, case_file::setup), SourceFiles::Holds::bytes);
  for (auto const& [name, file, frame] : {std::tuple{"reference", case_file::reference, &read.frames.reference},
                                          std::tuple{"flow", case_file::flow, &read.frames.flow}}) {
    std::string const path = in_case(folder, file), told = compared.sources.sha256(name);
    *frame = sources.add_image(name, path);
    if (told.empty() || told == sources.sha256(name)) continue;
    throw DataError(ErrorCode::changed, path,
                    fmt::format("is another frame than the vectors were measured on (the SHA-256 of its pixels is "
                                "{:.12}..., not {:.12}...); restore the old one, or render and correlate {} again",
                                sources.sha256(name), told, folder));
  }
  for (SourceFiles::Source const& source : compared.sources.all()) {
    bool const file = !source.name.empty() && !source.path.empty();
    if (file) sources.add(source.name, source.path, source.holds, source.sha256);
  }
  return read;
}

/// Returns the commands that reproduce the report, which is the last one.
std::vector<std::string> commands_of(ReportOptions const& options) {
  std::string const place = shell_word(options.source);
  std::string of_vectors = options.vectors.empty() ? "" : " --vectors " + shell_word(options.vectors);
  if (!options.conventions.empty()) of_vectors += " --conventions " + shell_word(options.conventions);
  std::vector<std::string> commands{"gladstone render setup.toml -o " + place};
  if (options.vectors.empty()) commands.push_back("gladstone correlate " + place);
  for (char const* command : {"compare", "report"}) {
    commands.push_back(fmt::format("gladstone {} {}{}", command, place, of_vectors));
  }
  for (std::string const& word : options.density_words) commands.back() += ' ' + shell_word(word);
  return commands;
}

/// Reconstructs the density with its error budget, if options ask for it.
std::optional<Reconstruction> reconstruct_compared(ReportOptions const& options, Comparison const& compared,
                                                   Backend const& device) {
  if (!options.density) return std::nullopt;
  ReconstructOptions density = *options.density;
  density.vectors = options.vectors;
  if (!options.conventions.empty()) density.conventions = options.conventions;
  density.budget = true;
  return reconstruct_case(options.source, density, device, compared.setup.get(), &compared);
}

/// Adds the errors, their causes and the estimated uncertainty.
void add_error_sections(ReportPage& page, CaseView const& view) {
  Comparison const& all = view.comparison;
  std::vector<NamedFigure> figures = make_comparison_figures(all);
  auto const take = [&figures](std::string_view name) {
    return std::find_if(figures.begin(), figures.end(), [name](auto const& one) { return one.name == name; })->figure;
  };
  Chart histograms{
      "histogram", "Distribution of the error", page.findings.front(), {{"all", take("error_histograms")}}};
  for (ErrorSeries const& one : view.errors)
    histograms.figures.push_back({one.name, make_error_histograms("Measurement error " + one.name, {one})});
  page.sections.push_back({"Errors", {std::move(histograms), errors_table(view)}});
  page.sections.push_back(
      {"Causes of error",
       {budget_chart("Error of every cause", take("error_budget"), all.shown_budget()),
        budget_table("The error budget [px]; the terms correlate, so that their squares do not add up",
                     all.shown_budget()),
        Paragraph{explain_budget(all)}}});
  ReportSection uncertainty{"Uncertainty", {TextList{uncertainty_statements(view)}}};
  if (std::optional<Chart> chart = reliability_chart(all)) uncertainty.blocks.emplace_back(*std::move(chart));
  page.sections.push_back(std::move(uncertainty));
}

/// Returns the name of a CASE folder without the folders above it.
std::string case_name(std::string const& folder) {
  std::string const name = fs::path(folder).lexically_normal().filename().string();
  if (!name.empty()) return name;
  return fs::absolute(folder).lexically_normal().parent_path().filename().string();
}

}  // namespace

ReportPage case_report(ReportOptions const& options, Backend const& device) {
  CompareOptions compare;
  compare.vectors = options.vectors;
  if (!options.conventions.empty()) compare.conventions = options.conventions;
  compare.reuse = true;
  CaseView view(compare_case(options.source, device, compare));
  Comparison const& all = view.comparison;
  add_maps(view);
  CaseSources const sources = read_case_sources(options.source, all);
  ReportPage page;
  page.title = "Case " + case_name(options.source);
  page.question = fmt::format(
      "How large is the error of this {} measurement, and what causes it? {} vectors, compared with the light rays.",
      comparison_kind(all).title, all.vectors_in_file());
  page.findings = summarize_findings(view);
  bool const mistaken = all.detected && all.detected->mistake.found();
  if (mistaken || !all.complete) {
    page.doubtful.push_back(options.vectors.empty() ? in_case(options.source, case_file::vectors) : options.vectors);
  }
  std::optional<LayoutView> const bench = layout_view(all.setup->copy());
  if (bench) page.sections.push_back(layout_section(*bench, "the case"));
  page.sections.push_back({"Images", {frame_pictures(sources.frames, "The two frames")}});
  if (!view.maps.empty())
    page.sections.push_back({"Maps",
                             {Chart{"field", "Displacement, errors, and the contribution of each cause",
                                    page.findings.front(), std::move(view.maps)}}});
  add_error_sections(page, view);
  std::vector<std::string> const commands = commands_of(options);
  std::optional<Reconstruction> const density = reconstruct_compared(options, all, device);
  if (density) {
    page.findings.push_back(summarize_density(*density));
    page.sections.push_back(density_section(page, *density));
  } else if (comparison_kind(all).experiment.measures_density) {
    page.sections.push_back(missing_density_section(commands.back()));
  }
  auto const draw = [&](std::string const& folder, std::string const& format) {
    std::vector<std::string> drawn = draw_comparison(folder, all, format);
    auto const add = [&](std::vector<std::string> paths) {
      for (std::string& path : paths) drawn.push_back(std::move(path));
    };
    if (density) add(draw_density_figures(folder, format, *density));
    if (bench) add(draw_layout_and_map(folder, format, *bench));
    return drawn;
  };
  if (ReportSection figures = drawn_figures(options, draw); !figures.blocks.empty()) {
    page.sections.push_back(std::move(figures));
  }
  std::string const setup = in_case(options.source, case_file::setup);
  page.sections.push_back(
      {"Settings",
       {Verbatim{"The resolved setup", read_text_file(setup)},
        Verbatim{"Summary of the rendering", read_text_file(in_case(options.source, case_file::summary))}}});
  page.sections.push_back(provenance_section(sources.files, commands));
  return page;
}

}  // namespace gladstone::inline report
