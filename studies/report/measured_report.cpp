#include <fmt/format.h>
#include <fmt/ranges.h>

#include <filesystem>

#include "analysis/errors/error_summary.h"
#include "render/files/text_file.h"
#include "render/scene/read_setup_document.h"
#include "studies/case/warning_log.h"
#include "studies/compare/reconstruct_case.h"
#include "studies/design/measurement_inputs.h"
#include "studies/design/sheet.h"
#include "studies/report/case_view.h"
#include "studies/report/density_section.h"
#include "studies/report/layout_view.h"
#include "studies/report/measured_files.h"
#include "studies/report/measured_findings.h"
#include "studies/report/report.h"
#include "studies/report/simulated_twin.h"
#include "studies/report/twin_density.h"
#include "studies/sweep/job_array.h"

namespace gladstone::inline report {
namespace {

namespace fs = std::filesystem;

/// Returns the displacement as an input: a representative vector with typical displacement and uncertainty.
MeasurementInput typical_displacement(MeanOfRepeats const& mean, double formula_px) {
  std::vector<double> const sigma = finite_components(mean.field.sigma_px);
  bool const repeated = mean.count > 1;
  MeasurementInput input;
  input.key = "displacement_px";
  input.value = compute_rms(finite_components(mean.field.displacement_px));
  input.sigma = repeated ? compute_rms(sigma)  // the rms is used, because the median of few repeats is biased
                                               // low
                : sigma.empty() ? formula_px
                                : quantile(sigma, 0.5);
  if (repeated) input.degrees_of_freedom = static_cast<double>(mean.count - 1);
  input.enters = GradientInput::displacement;
  return input;
}

/// Simulates the twin of a measurement with vectors on a lattice.
SimulatedTwin twin_of(CaseSetup const& loaded, DisplacementField const& field, MeasuredGradients const& all,
                      double pixel_at_medium, Backend const& device) {
  double const spacing = (field.position_px[1].x - field.position_px[0].x) * pixel_at_medium;
  Vec2d const middle = (field.position_px.front() + field.position_px.back()) / 2.0;
  Vec2d const axis{(loaded.setup.camera.columns - 1) / 2.0, (loaded.setup.camera.rows - 1) / 2.0};
  Vec2d const centre = Vec2d{middle.x - axis.x, axis.y - middle.y} * pixel_at_medium;
  return simulate_twin(loaded, compute_twin_density(all.gradient, field.columns, field.rows, spacing), spacing, centre,
                       open_device(device.name()));
}

ReportSection causes_section(SimulatedTwin const* twin) {
  ReportSection causes{"Causes of error, by the simulated twin", {}};
  if (!twin || !twin->failed.empty()) {
    causes.blocks.emplace_back(
        Paragraph{twin ? "The simulated twin could not be computed: " + twin->failed
                       : "The simulated twin requires a complete lattice of vectors, which these are not."});
    return causes;
  }
  causes.blocks.emplace_back(Paragraph{fmt::format(
      "The vectors were integrated to a density, which was placed in front of the setup's camera (its middle {} x {} "
      "px), rendered with its noise {} times, each time with other dots (seeds {}), and measured again. The "
      "measurement scatters by {:.3g} px between repeats; the error common to all repeats is {:.3g} px rms relative to "
      "Eq. 9, which contains the uncorrected bias and the bias of the estimator.",
      twin->columns, twin->rows, twin->seeds.size(), fmt::join(twin->seeds, ", "), twin->random_px,
      twin->systematic_px)});
  ErrorBudget const& budget = twin->comparison.shown_budget();
  causes.blocks.emplace_back(budget_chart("Error of every cause, of the simulated twin",
                                          make_budget_bars("Error budget of the simulated twin", budget), budget));
  causes.blocks.emplace_back(
      budget_table("Budget by cause, of the simulated twin and not of the measurement itself [px]", budget));
  causes.blocks.emplace_back(Paragraph{explain_budget(twin->comparison)});
  return causes;
}

ReportSection maps_section(DisplacementField const& field, MeasuredGradients const& all, CameraSetup const& camera,
                           std::string const& alt) {
  ReportSection maps{
      "Maps", {Chart{"field", "Displacement, gradient and their uncertainty", alt, make_measured_maps(field, all)}}};
  // fraction of the image; the vectors of full frames only omit half a window at each edge
  constexpr double doubtful = 0.5;
  if (double const share = spanned_share(field, camera); share < doubtful) {
    maps.blocks.emplace_back(
        Paragraph{fmt::format("The vectors span {:.2g} % of the camera's {} x {} px: only part of the frame was "
                              "measured, or camera.pixels of the setup does not belong to these frames.",
                              100 * share, camera.columns, camera.rows)});
  }
  return maps;
}

std::string command_of(ReportOptions const& options) {
  std::string command = "gladstone report " + shell_word(options.source);
  if (!options.vectors.empty()) command += " --vectors " + shell_word(options.vectors);
  if (!options.conventions.empty()) command += " --conventions " + shell_word(options.conventions);
  if (!options.repeats.empty()) command += " --repeats";
  for (std::string const& file : options.repeats) command += ' ' + shell_word(file);
  for (std::string const& word : options.density_words) command += ' ' + shell_word(word);
  return command;
}

/// Reconstructs the density of the vectors as gladstone reconstruct does, or that of the mean of repeats.
std::optional<Reconstruction> reconstruct_measured(ReportOptions const& options, MeanOfRepeats const& mean,
                                                   CaseSetup const& loaded, Backend const& device) {
  if (!options.density) return std::nullopt;
  ReconstructOptions density = *options.density;
  density.vectors = options.vectors;
  if (!options.conventions.empty()) density.conventions = options.conventions;
  if (mean.count == 1) return reconstruct_case(options.source, density, device, &loaded);
  Reconstruction result = reconstruct_density(mean.field, loaded.setup, loaded.correlate.window_px.back(), density);
  log_warnings(result.warnings);
  return result;
}

CaseSetup measured_bench(std::string const& setup_file, std::vector<UncertainInput>& uncertain) {
  SetupDocument document = read_setup_document(setup_file);
  uncertain = extract_uncertain_inputs(document);
  CaseSetup loaded = load_case_setup(std::move(document));
  if (!loaded.setup.experiment().measures_density || !loaded.setup.has_closed_form_layout()) {
    throw DataError(ErrorCode::unsupported, setup_file,
                    "does not describe a BOS set-up with a thin lens on the axis, perpendicular to the target (the "
                    "uncertainty of a measurement requires one); describe the measurement by such a set-up");
  }
  return loaded;
}

}  // namespace

ReportPage measured_report(ReportOptions const& options, Backend const& device) {
  std::vector<UncertainInput> uncertain;
  MeasuredFiles const files = measured_files(options);
  CaseSetup const loaded = measured_bench(files.setup, uncertain);
  CameraSetup const& camera = loaded.setup.camera;
  check_frames_match_camera(files, options, camera);
  FixedDesignParameters const given = collect_fixed_parameters(loaded);
  DesignPoint<double> const bench = make_design_point(loaded.setup, given);
  RepeatedVectors const read = read_repeats(files, options, camera);
  MeanOfRepeats const mean = mean_of_repeats(read.fields, bench.random_error());
  DisplacementField const& field = mean.field;
  if (finite_components(field.displacement_px).empty())
    throw DataError(ErrorCode::undetermined, files.vectors,
                    "has no vector with a displacement; correlate the images again");

  std::optional<Reconstruction> const density = reconstruct_measured(options, mean, loaded, device);
  std::vector<MeasurementInput> inputs{typical_displacement(mean, bench.random_error())};
  for (MeasurementInput& input : measurement_inputs(loaded, uncertain, *device.renderer))
    inputs.push_back(std::move(input));
  GradientMeasurement<double> const at =
      gradient_measurement(loaded.setup, given.window.window_px(), inputs.front().value);
  PropagatedResult const typical = propagate(at, inputs).front();
  MeasuredGradients const all = compute_gradients(field, bench, common_relative_uncertainty(at, inputs));
  bool const gridded = field.columns > 1 && field.rows > 1;
  std::optional<SimulatedTwin> twin;
  if (gridded && all.count > 0) twin = twin_of(loaded, field, all, bench.pixel_at_medium(), device);
  MeasurementKnown const known{all, typical, inputs, mean, twin ? &*twin : nullptr, bench.sensitivity()};
  MeasurementStatements const said = measurement_statements(known);

  ReportPage page;
  page.title = "Measurement " + fs::absolute(options.source).lexically_normal().filename().string();
  page.question = fmt::format("What is the uncertainty of the density gradients of this measurement? {} vectors of {}.",
                              field.size(), fs::path(files.vectors).filename().string());
  page.findings = {said.measurand, said.expanded, said.bias};
  if (density) page.findings.push_back(summarize_density(*density));
  page.doubtful = read.incomplete;
  std::optional<LayoutView> const drawn_bench = layout_view(loaded.copy());
  if (drawn_bench) page.sections.push_back(layout_section(*drawn_bench, "the measurement"));
  if (files.frames) page.sections.push_back({"Images", {frame_pictures(*files.frames, "The two frames")}});
  if (gridded) page.sections.push_back(maps_section(field, all, camera, said.measurand));
  page.sections.push_back({"Uncertainty", {TextList{said.all()}, inputs_table(known)}});
  page.sections.push_back(causes_section(known.twin));
  page.sections.push_back(density ? density_section(page, *density) : missing_density_section(command_of(options)));
  auto const draw = [&](std::string const& folder, std::string const& format) {
    std::vector<std::string> drawn;
    auto const add = [&](std::vector<std::string> paths) {
      for (std::string& path : paths) drawn.push_back(std::move(path));
    };
    if (gridded) drawn.push_back(draw_measured_maps(folder + "/measured_maps." + format, field, all));
    if (density) add(draw_density_figures(folder, format, *density));
    if (drawn_bench) add(draw_layout_and_map(folder, format, *drawn_bench));
    return drawn;
  };
  if (ReportSection figures = drawn_figures(options, draw); !figures.blocks.empty()) {
    page.sections.push_back(std::move(figures));
  }
  page.sections.push_back({"Settings", {Verbatim{"The setup", read_text_file(files.setup)}}});
  page.sections.push_back(provenance_section(files.sources, {command_of(options)}));
  files.sources.check();
  return page;
}

}  // namespace gladstone::inline report
