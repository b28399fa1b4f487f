#include "studies/design/design.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "render/base/error.h"
#include "render/files/output_file.h"
#include "render/medium/field_volume.h"
#include "render/scene/experiment.h"
#include "render/scene/read_setup_document.h"
#include "studies/case/case_files.h"
#include "studies/design/bos_sheet.h"
#include "studies/design/piv_sheet.h"
#include "studies/design/sheet_text.h"
#include "studies/sweep/manifest.h"

namespace gladstone::inline design {
namespace {

/// Prevents the setup of a rendered case or planned study from being overwritten, since its results would no longer
/// match.
/// @throws OutputError if `path` is the setup of a rendered case or planned study
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

AnsweredQuestion answered(DesignRequest const& request, SetupDocument const& document, CaseSetup const& loaded,
                          DesignQuestion question) {
  AnsweredQuestion result{std::move(question), {}, {}, {}, {}};
  result.variants = design_variants(document, result.question, result.skipped, &loaded);
  std::vector<DesignBranch> const branches = design_branches(result.variants, result.question);
  Requirements const& requirements = result.question.requirements;
  result.answer = recommend(requirements.objective, requirements.limits, branches);
  if (request.verification.benches > 0 && result.answer.feasible()) {
    result.verification =
        verify(result.question, result.variants, branches, result.answer, request.verification, request.open_device());
  }
  return result;
}

void add_bos_sheet(DesignRequest const& request, CaseSetup const& loaded, std::vector<UncertainInput> const& uncertain,
                   DesignReport& report) {
  report.given = std::make_unique<FixedDesignParameters>(collect_fixed_parameters(loaded));
  report.best = make_design_point(loaded.setup, *report.given);
  report.sheet = bos_sheet(loaded.setup, *report.best);
  if (uncertain.empty()) return;
  Backend const device = request.open_device();
  report.uncertainty =
      measurement_uncertainty(loaded, uncertain, *report.best, sheet_gradient(*report.given), *device.renderer);
}

void add_piv_sheet(DesignRequest const& /*request*/, CaseSetup const& loaded,
                   std::vector<UncertainInput> const& /*uncertain*/, DesignReport& report) {
  report.sheet = piv_sheet(loaded);
}

/// Experiment, and the function that adds its design sheet to a report.
struct SheetKind {
  Experiment const& experiment;
  void (*add)(DesignRequest const& request, CaseSetup const& loaded, std::vector<UncertainInput> const& uncertain,
              DesignReport& report);
};
constexpr std::array sheet_kinds{SheetKind{bos_experiment, add_bos_sheet}, SheetKind{piv_experiment, add_piv_sheet}};

/// Adds the design sheet of a setup.
void add_sheet(DesignRequest const& request, CaseSetup const& loaded, std::vector<UncertainInput> const& uncertain,
               DesignReport& report) {
  if (!std::isfinite(loaded.setup.lens.f_number)) {
    throw DataError(ErrorCode::missing_key, request.setup,
                    "has no aperture stop (lens.f_number); a design requires the light cone, so give a number");
  }
  report.warnings = loaded.warnings;
  Warnings const neglected = list_neglected_effects(loaded.setup);
  report.warnings.insert(report.warnings.end(), neglected.begin(), neglected.end());
  Warnings const of_field = header_warnings(loaded.setup.medium);
  report.warnings.insert(report.warnings.end(), of_field.begin(), of_field.end());
  if (SheetKind const* const kind = find_kind(sheet_kinds, loaded.setup.experiment())) {
    kind->add(request, loaded, uncertain, report);
  }
  report.text += fmt::format("{}\n{}", request.setup, sheet_text(report.sheet));
  if (report.uncertainty) report.text += uncertainty_text(*report.uncertainty);
}

/// Adds the recommended design, and its verification.
/// @param loaded  the setup as given
void add_answer(DesignRequest const& request, SetupDocument const& document, DesignQuestion question,
                CaseSetup const& loaded, std::optional<OutputFile>& applied, DesignReport& report) {
  AnsweredQuestion const& result = report.answer.emplace(answered(request, document, loaded, std::move(question)));
  report.text += answer_text(result);
  report.feasible = result.feasible();
  if (!result.answer.feasible()) return;
  report.best = result.best();
  report.recommended_sheet = bos_sheet(loaded.setup, *report.best);
  if (std::string const missed = missed_rows_text(*report.recommended_sheet); !missed.empty())
    report.text += "rows of the design sheet that the recommended set-up does not meet with a margin\n" + missed;
  if (applied && report.feasible) {
    DesignVariant const& variant = result.variants[result.chosen().branch.variant];
    std::string const text = applied_setup(variant, result.question, *report.best).written();
    applied->write(text.data(), text.size());
    applied->commit();
  }
}

}  // namespace

DesignReport answer_design(DesignRequest const& request) {
  SetupDocument document = read_setup_document(request.setup, request.overrides);
  return answer_design(std::move(document), request);
}

DesignReport answer_design(SetupDocument document, DesignRequest const& request) {
  SetupDocument const written = document.copy();
  std::vector<UncertainInput> const uncertain = extract_uncertain_inputs(document);
  std::optional<DesignQuestion> question = read_design_question(document);
  // reports the problems of the setup and those of the requested design together
  CaseSetup loaded = load_case_setup(std::move(document));
  if (!loaded.setup.experiment().correlated) {
    throw DataError(ErrorCode::wrong_format, request.setup,
                    "is a calibration (the formulas describe BOS and PIV); use a setup of one of these");
  }
  if (!question && !request.apply.empty()) {
    throw DataError(ErrorCode::missing_key, request.setup,
                    "has no [requirements], so that --apply has nothing to write; add them");
  }
  DesignReport report;
  std::optional<OutputFile> applied;
  if (!request.apply.empty()) {
    refuse_setup_of_results(request.apply);
    applied.emplace(request.apply, "TOML");
  }
  add_sheet(request, loaded, uncertain, report);
  if (question) {  // the recommended design first, then the sheet of the setup as written
    std::string const sheet = std::exchange(report.text, "");
    add_answer(request, written, std::move(*question), loaded, applied, report);
    report.text += "design sheet of the setup as written\n" + sheet;
  }
  report.setup = std::move(loaded.setup);
  return report;
}

nlohmann::ordered_json design_json(DesignReport const& report) {
  nlohmann::ordered_json json{{"sheet", sheet_json(report.sheet)}};
  if (report.uncertainty) json["uncertainty"] = uncertainty_json(*report.uncertainty);
  if (report.answer) json.update(answer_json(*report.answer));
  if (report.recommended_sheet) json["recommended_sheet"] = sheet_json(*report.recommended_sheet);
  return json;
}

}  // namespace gladstone::inline design
