#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include "render/base/error.h"
#include "render/files/source_files.h"
#include "render/files/text_file.h"
#include "studies/case/case_files.h"
#include "studies/figures/study_axes.h"
#include "studies/figures/study_figures.h"
#include "studies/report/layout_view.h"
#include "studies/report/report.h"
#include "studies/report/study_view.h"
#include "studies/sweep/job_array.h"
#include "studies/sweep/study_table.h"

namespace gladstone::inline report {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t most_told = 12;  ///< maximum number of values of an axis in a list

/// Reads the frames of a case; nullopt if the study has not stored them.
std::optional<FramePair<double>> read_frames(std::string const& run, StudyRow const& row, SourceFiles& sources) {
  fs::path const folder = fs::path(run) / run_file::cases / std::to_string(row.index);
  if (!fs::exists(folder / case_file::reference)) return std::nullopt;
  auto const read = [&](char const* name) {
    return sources.add_image(fmt::format("{} of case {}", name, row.index), (folder / name).string());
  };
  return FramePair<double>{read(case_file::reference), read(case_file::flow)};
}

/// Returns the frames of a case, if the study has stored them.
ReportBlock frames_of(std::string const& run, StudyView const& study, StudyRow const& row,
                      std::optional<FramePair<double>> const& frames, std::string const& which) {
  std::string const title =
      fmt::format("{}: case {}, {}, rms {:.3g} px", which, row.index, study.title(row), study.of(row, study.main));
  if (!frames) {
    return Paragraph{fmt::format("{}. Its images were not kept: gladstone sweep run {} --keep-images --case {}", title,
                                 shell_word(run), row.index)};
  }
  return frame_pictures(*frames, title);
}

/// Returns the set-up of a setup; nullopt if a file that it names no longer exists, or if it is invalid without the
/// study's axes.
std::optional<LayoutView> bench_of_text(std::string const& setup, std::string const& name) {
  if (setup.empty()) return std::nullopt;
  try {
    return layout_view(load_case_setup(SetupDocument::from_text(setup, name)));
  } catch (Error const&) {
    return std::nullopt;
  }
}

/// Reads a file of a RUN; empty if it does not exist, as in runs planned by older versions.
std::string text_in_run(std::string const& run, char const* name) {
  std::string const path = (fs::path(run) / name).string();
  return fs::exists(path) ? read_text_file(path) : std::string();
}

/// Describes the base setup and the axes of the study.
ReportSection setup_section(StudyView const& study, LayoutView const* base) {
  ReportSection section{"Set-up", {}};
  if (base) section = layout_section(*base, "the base");
  TextList axes;
  for (StudyAxis const& axis : study.table.axes) {
    std::string values;
    for (std::size_t i = 0; i < axis.labels.size() && i < most_told; ++i) {
      values += (i == 0 ? "" : "; ") + axis.labels[i];
    }
    std::size_t const more = axis.labels.size() - std::min(axis.labels.size(), most_told);
    axes.items.push_back(axis_title(axis.key) + ": " + values + (more > 0 ? fmt::format("; and {} more", more) : ""));
  }
  section.blocks.insert(section.blocks.begin(),
                        {Paragraph{"Every case is based on one setup. The study changes these keys:"}, axes});
  return section;
}

/// Returns the inputs of the report except the frames: planned study and its tables.
SourceFiles run_sources(std::string const& run) {
  SourceFiles sources;
  for (char const* const name : {run_file::study, run_file::base, run_file::manifest}) {
    std::string const path = (fs::path(run) / name).string();
    if (fs::exists(path)) sources.add(name, path, SourceFiles::Holds::bytes);
  }
  return sources;
}

/// Best and worst finished case by the main measure of a study.
struct Extremes {
  StudyRow const* best;
  StudyRow const* worst;
};

Extremes extremes_of(StudyView const& study) {
  auto const worse = [&](StudyRow const* a, StudyRow const* b) {
    double const of_a = study.of(*a, study.main), of_b = study.of(*b, study.main);
    return std::isfinite(of_a) && (!std::isfinite(of_b) || of_a < of_b);  // unknown values are excluded
  };
  StudyRow const* const best = *std::min_element(study.finished.begin(), study.finished.end(), worse);
  StudyRow const* worst = best;
  for (StudyRow const* row : study.finished) {
    if (study.of(*row, study.main) > study.of(*worst, study.main)) worst = row;
  }
  return {best, worst};
}

/// Adds a figure if the study has its values.
void add_figure(std::vector<NamedFigure>& figures, std::string name, std::optional<Figure> figure) {
  if (figure) figures.push_back({std::move(name), *std::move(figure)});
}

/// Adds the figures of the errors, their causes and their uncertainty.
/// @pre the first finding is that about the best and the worst case
void add_charts(ReportPage& page, StudyView const& study) {
  StudyFigureMaker const maker(study.table);
  std::vector<std::size_t> axes = maker.varied();
  using Make = std::optional<Figure> (StudyFigureMaker::*)(std::size_t axis) const;
  auto const over_axes = [&](Make make) {
    std::vector<NamedFigure> figures;
    for (std::size_t const axis : axes) add_figure(figures, maker.title(axis), (maker.*make)(axis));
    return figures;
  };
  auto const add_chart = [](ReportSection& section, char const* kind, char const* title, std::string const& alt,
                            std::vector<NamedFigure> figures) {
    if (!figures.empty()) section.blocks.emplace_back(Chart{kind, title, alt, std::move(figures)});
  };
  std::vector<NamedFigure> maps, points;
  for (std::size_t i = 0; i < axes.size(); ++i) {
    for (std::size_t j = i + 1; j < axes.size(); ++j)
      add_figure(maps, fmt::format("{}, {}", maker.title(axes[i]), maker.title(axes[j])),
                 maker.make_map(axes[j], axes[i]));
  }
  add_figure(points, "error and signal", maker.make_case_points());
  ReportSection errors{"Error over the axes", {}}, causes{"Causes of error", {}}, uncertainty{"Uncertainty", {}};
  std::string const& extremes = page.findings.front();
  add_chart(errors, "curves", "Error over an axis", extremes, over_axes(&StudyFigureMaker::make_errors));
  add_chart(errors, "cells", "Error over two axes", strongest_axis(study), std::move(maps));
  add_chart(errors, "scatter", "Error against the signal, one point per case", extremes, std::move(points));
  add_chart(errors, "repeats", "Error that repeats have in common, and scatter between them", extremes,
            over_axes(&StudyFigureMaker::make_repeats));
  add_chart(uncertainty, "coverage", "Fraction of the errors that the estimated uncertainty covers",
            uncertainty_finding(study), over_axes(&StudyFigureMaker::make_coverage));
  if (axes.empty() && !study.table.axes.empty()) axes = {0};  // a study of one point has a budget, too
  if (std::vector<NamedFigure> budgets = over_axes(&StudyFigureMaker::make_budget); !budgets.empty()) {
    causes.blocks.emplace_back(
        Paragraph{"The terms of the budget lead from theory to the measurement. They are correlated, so that their "
                  "heights do not add up in quadrature."});
    add_chart(causes, "causes", "rms of every cause", largest_cause(study), std::move(budgets));
  }
  for (ReportSection* const section : {&errors, &causes, &uncertainty})
    if (!section->blocks.empty()) page.sections.push_back(std::move(*section));
}

/// Returns study, setups, seeds and builds.
/// @param best_text,whose_best  setup of the best case, and its name
ReportSection settings_section(std::string const& run, StudyView const& study, StudyRow const& best,
                               std::string const& base_text, std::string const& best_text,
                               std::string const& whose_best) {
  ReportSection settings{"Settings", {}};
  if (std::string text = text_in_run(run, run_file::study); !text.empty()) {
    settings.blocks.emplace_back(Verbatim{"The study", std::move(text)});
  }
  if (!base_text.empty()) {
    settings.blocks.emplace_back(Verbatim{"The base setup of all cases", base_text});
  }
  settings.blocks.emplace_back(Verbatim{"The setup of " + whose_best, best_text});
  std::string seeds, builds;
  std::vector<std::uint64_t> told;
  for (StudyRow const& row : study.table.rows) {
    if (std::find(told.begin(), told.end(), row.seed) != told.end()) continue;
    told.push_back(row.seed);
    seeds += fmt::format("{}{}", seeds.empty() ? "" : ", ", row.seed);
  }
  for (std::string const& build : study.table.builds) builds += (builds.empty() ? "" : ", ") + build;
  settings.blocks.emplace_back(Paragraph{
      fmt::format("Seeds of the repeats: {}. Computed by gladstone {} on {}.", seeds, builds, best.device())});
  return settings;
}

/// Returns the inputs of the report and the commands that reproduce it.
ReportSection origin_section(std::string const& run, SourceFiles const& sources) {
  std::string const place = shell_word(run);
  return provenance_section(sources, {"gladstone sweep plan study.toml -o " + place, "gladstone sweep run " + place,
                                      "gladstone sweep collect " + place, "gladstone report " + place});
}

}  // namespace

ReportPage run_report(ReportOptions const& options) {
  std::string const& run = options.source;
  StudyView const study(run);
  Extremes const extreme = extremes_of(study);
  StudyRow const &best = *extreme.best, &worst = *extreme.worst;
  ReportPage page;
  page.title = "Study " + study.table.name;
  page.question = describe_question(study);
  page.findings = {extremes(study, best, worst)};
  for (std::string const& finding :
       {other_rankings(study), largest_cause(study), strongest_axis(study), uncertainty_finding(study)}) {
    if (!finding.empty()) page.findings.push_back(finding);
  }
  auto const manifest_entries = read_manifest(run);
  std::string const base_text = text_in_run(run, run_file::base), best_text = manifest_entries[best.index].setup;
  std::string const whose_best = fmt::format("case {}, the best", best.index);
  std::optional<LayoutView> const base = bench_of_text(base_text, run_file::base),
                                  bench = bench_of_text(best_text, "the setup of " + whose_best);
  page.sections.push_back(setup_section(study, base ? &*base : nullptr));
  add_charts(page, study);
  SourceFiles sources = run_sources(run);
  std::optional<FramePair<double>> const of_best = read_frames(run, best, sources),
                                         of_worst = &worst == &best ? of_best : read_frames(run, worst, sources);
  ReportSection frames{"Best and worst case",
                       {frames_of(run, study, best, of_best, "Best"), frames_of(run, study, worst, of_worst, "Worst")}};
  if (bench && (!base || layout_text(*base) != layout_text(*bench))) {
    frames.blocks.push_back(layout_block(*bench, whose_best));
  }
  page.sections.push_back(std::move(frames));
  auto const draw = [&](std::string const& folder, std::string const& format) {
    std::vector<std::string> drawn = draw_study(folder, study.table, {format});
    if (!base) return drawn;
    for (std::string& path : draw_layout_and_map(folder, format, *base)) drawn.push_back(std::move(path));
    return drawn;
  };
  if (ReportSection figures = drawn_figures(options, draw); !figures.blocks.empty()) {
    page.sections.push_back(std::move(figures));
  }
  page.sections.push_back({"All cases", {cases_table(study)}});
  page.sections.push_back(settings_section(run, study, best, base_text, best_text, whose_best));
  page.sections.push_back(origin_section(run, sources));
  return page;
}

}  // namespace gladstone::inline report
