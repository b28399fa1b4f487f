#include "studies/design/design.h"

#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <optional>
#include <utility>

#include "render/base/error.h"
#include "render/files/output_file.h"
#include "render/medium/field_volume.h"
#include "studies/case/case_files.h"
#include "studies/design/answer_text.h"
#include "studies/design/measurement_inputs.h"
#include "studies/design/sheet.h"
#include "studies/design/sheet_text.h"
#include "studies/drawing/draw_figure.h"
#include "studies/figures/design_map.h"
#include "studies/figures/layout_figure.h"
#include "studies/figures/piv_map.h"
#include "studies/sweep/manifest.h"

namespace gladstone {
namespace {

/// Prevents the setup of a rendered case or planned study from being overwritten, since its results would no longer
/// match.
/// @throws OutputError if `path` is such a setup
void refuse_setup_of_results(std::string const& path) {
  std::error_code error;
  std::filesystem::path const folder = std::filesystem::absolute(path, error).parent_path();
  for (char const* const made : {case_file::summary, case_file::truth, run_file::manifest}) {
    if (!std::filesystem::exists(path, error) || !std::filesystem::exists(folder / made, error)) continue;
    throw OutputError(path, fmt::format("belongs to the results in this folder ({}), and would be overwritten; choose "
                                        "another output",
                                        made));
  }
}

/// Writes a figure into the folder; adds a warning if gnuplot is not installed.
void draw(DesignRequest const& request, DesignReport& report, std::string const& name, Figure const& figure) {
  std::filesystem::path const path = std::filesystem::path(request.figures) / (name + '.' + request.figure_format);
  try {
    draw_figure(figure, path.string());
    report.json["figures"].push_back(path.string());
  } catch (GnuplotMissing const& missing) {
    report.warnings.emplace_back(missing.what());
  }
}

void draw_layout_and_map(DesignRequest const& request, DesignReport& report, DesignPoint<double> const& bench,
                         DesignQuestion const* question) {
  draw(request, report, "layout", make_layout_figure(bench));
  draw(request, report, "design_map", make_design_map(bench, question));
}

void draw_piv(DesignRequest const& request, DesignReport& report, Setup const& setup) {
  draw(request, report, "layout", make_piv_layout_figure(setup));
  draw(request, report, "design_map", make_piv_map(setup));
}

AnsweredQuestion answered(DesignRequest const& request, SetupDocument const& document, DesignQuestion question) {
  AnsweredQuestion result{std::move(question), {}, {}, {}, {}};
  result.variants = design_variants(document, result.question, result.skipped);
  std::vector<DesignBranch> const branches = design_branches(result.variants, result.question);
  Requirements const& requirements = result.question.requirements;
  result.answer = recommend(requirements.objective, required_limits(requirements), branches);
  if (request.verification.benches > 0 && result.answer.feasible()) {
    result.verification =
        verify(result.question, result.variants, branches, result.answer, request.verification, request.open_device());
  }
  return result;
}

/// Adds the design sheet of a setup and its figures.
void add_sheet(DesignRequest const& request, CaseSetup const& loaded, std::vector<UncertainInput> const& uncertain,
               bool draws, DesignReport& report) {
  if (!std::isfinite(loaded.setup.lens.f_number)) {
    throw DataError(ErrorCode::missing_key, request.setup,
                    "has no aperture stop (lens.f_number); a design requires the light cone, so give a number");
  }
  report.warnings = loaded.warnings;
  std::vector<std::string> const neglected = list_neglected_effects(loaded.setup);
  report.warnings.insert(report.warnings.end(), neglected.begin(), neglected.end());
  std::vector<std::string> const of_field = header_warnings(loaded.setup.medium);
  report.warnings.insert(report.warnings.end(), of_field.begin(), of_field.end());
  DesignSheet sheet;
  std::optional<MeasurementUncertainty> uncertainty;
  if (loaded.setup.piv) {
    sheet = piv_sheet(loaded);
    if (draws) draw_piv(request, report, loaded.setup);
  } else {
    FixedDesignParameters const given = collect_fixed_parameters(loaded);
    DesignPoint<double> const bench = make_design_point(loaded.setup, given);
    sheet = bos_sheet(loaded.setup, bench);
    if (draws) draw_layout_and_map(request, report, bench, nullptr);
    if (!uncertain.empty()) {
      Backend const device = request.open_device();
      uncertainty = measurement_uncertainty(loaded, uncertain, bench, sheet_gradient(given), *device.renderer);
    }
  }
  report.json["sheet"] = sheet_json(sheet);
  report.text += fmt::format("{}\n{}", request.setup, sheet_text(sheet));
  if (!uncertainty) return;
  report.json["uncertainty"] = uncertainty_json(*uncertainty);
  report.text += uncertainty_text(*uncertainty);
}

/// Adds the answer to the design question.
/// @param loaded  the setup as given
void add_answer(DesignRequest const& request, SetupDocument const& document, DesignQuestion question,
                CaseSetup const& loaded, std::optional<OutputFile>& applied, DesignReport& report) {
  AnsweredQuestion const result = answered(request, document, std::move(question));
  report.json.update(answer_json(result));
  report.text += answer_text(result);
  report.feasible = result.feasible();
  if (!result.answer.feasible()) {
    // draw the given setup together with the requirements
    FixedDesignParameters const given = collect_fixed_parameters(loaded);
    if (!request.figures.empty()) {
      draw_layout_and_map(request, report, make_design_point(loaded.setup, given), &result.question);
    }
    return;
  }
  DesignPoint<double> const best = result.best();
  DesignSheet const sheet = bos_sheet(loaded.setup, best);
  report.json["recommended_sheet"] = sheet_json(sheet);
  if (std::string const missed = missed_rows_text(sheet); !missed.empty())
    report.text += "rows of the design sheet that the recommended set-up does not meet with a margin\n" + missed;
  if (!request.figures.empty()) {
    draw_layout_and_map(request, report, best, &result.question);
    if (!result.answer.front.empty()) {
      draw(request, report, "front", make_design_front(result.answer, result.question.requirements.objective));
    }
  }
  if (applied && report.feasible) {
    DesignVariant const& variant = result.variants[result.chosen().branch.variant];
    std::string const text = applied_setup(variant, result.question, best);
    applied->write(text.data(), text.size());
    applied->commit();
  }
}

}  // namespace

DesignReport design(DesignRequest const& request) {
  SetupDocument document = read_setup_document(request.setup, request.overrides);
  return design(std::move(document), request);
}

DesignReport design(SetupDocument document, DesignRequest const& request) {
  SetupDocument const written = document.copy();
  std::vector<UncertainInput> const uncertain = extract_uncertain_inputs(document);
  std::optional<DesignQuestion> question = read_design_question(document);
  CaseSetup const loaded = load_case_setup(std::move(document));  // reports problems of setup and question together
  if (!loaded.setup.experiment().correlated) {
    throw DataError(ErrorCode::wrong_format, request.setup,
                    "is a calibration (the formulas describe BOS and PIV); use a setup of one of these");
  }
  if (!question && !request.apply.empty()) {
    throw DataError(ErrorCode::missing_key, request.setup,
                    "has no [requirements], so that --apply has nothing to write; add them");
  }
  DesignReport report;
  if (!request.figures.empty()) report.json["figures"] = nlohmann::ordered_json::array();
  std::optional<OutputFile> applied;
  if (!request.apply.empty()) {
    refuse_setup_of_results(request.apply);
    applied.emplace(request.apply, "TOML");
  }
  add_sheet(request, loaded, uncertain, !request.figures.empty() && !question, report);
  if (question) {  // the answer first, then the sheet of the setup as written
    std::string const sheet = std::exchange(report.text, "");
    add_answer(request, written, std::move(*question), loaded, applied, report);
    report.text += "design sheet of the setup as written\n" + sheet;
  }
  return report;
}

}  // namespace gladstone
