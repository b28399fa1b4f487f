#include "studies/compare/stereo.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "analysis/correlation/correlation_methods.h"
#include "analysis/stereo/interpolated_field.h"
#include "analysis/stereo/residual_validation.h"
#include "render/base/error.h"
#include "render/base/frame_pair.h"
#include "render/base/not_a_number.h"
#include "render/base/units.h"
#include "render/files/hdf5_file.h"
#include "render/files/image_file.h"
#include "render/files/input_file.h"
#include "render/files/stop_point.h"
#include "studies/case/case.h"
#include "studies/case/truth_file.h"
#include "studies/compare/compared_files.h"
#include "studies/compare/compared_vectors.h"
#include "studies/compare/correlate.h"
#include "studies/compare/stereo_alignment.h"
#include "studies/compare/stereo_cameras.h"
#include "studies/compare/stereo_scores.h"
#include "studies/compare/stereo_truth.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;

/// Vectors, camera and truth of one input.
struct StereoInput {
  std::optional<CaseSetup> loaded;
  MeasuredVectors vectors;
  stereo::CalibratedCamera camera;
  std::optional<GroundTruth> truth;
  std::string path;         ///< of the vectors
  std::string calibration;  ///< path; empty: the setup's exact camera
  double window_px = 0.0;
};

void check_stereo_options(StereoOptions const& options) {
  std::vector<SetupProblem> problems;
  if (!options.calibrations.empty() && options.calibrations.size() != 2)
    problems.push_back(
        {"--calibration", fmt::format("expected two files, one for each camera, got {}", options.calibrations.size())});
  stereo::ObjectPlane const& plane = options.plane;
  if (!std::isfinite(plane.height)) problems.push_back({"--sheet-z", "expected a finite number"});
  if (!is_finite(plane.slope)) problems.push_back({"--sheet-slope", "expected two finite numbers"});
  if (!(options.spacing >= 0.0 && std::isfinite(options.spacing)))
    problems.push_back({"--spacing", "expected a positive distance in mm"});
  if (options.window_px && !(*options.window_px >= 0.0 && std::isfinite(*options.window_px)))
    problems.push_back({"--window", "expected a size in px, 0 for independent errors"});
  if (options.images.size() % 2 != 0)
    problems.push_back({"--images", fmt::format("expected images of the first and of the second camera in turn, got an "
                                                "odd number ({})",
                                                options.images.size())});
  if (!(options.residual_limit >= 0.0 && std::isfinite(options.residual_limit)))
    problems.push_back({"--residual-limit", "expected a positive number of standard uncertainties, or 0"});
  if (!problems.empty()) throw SetupError(std::move(problems));
}

/// Returns the images from which the sheet is determined; empty without --align if the cases do not contain them.
std::vector<std::string> find_sheet_images(StereoOptions const& options) {
  if (!options.images.empty()) return options.images;
  std::vector<std::string> images;
  for (char const* frame : {case_file::reference, case_file::flow})
    for (std::string const& place : options.inputs) {
      std::error_code error;
      if (!options.align && !fs::exists(fs::path(place) / frame, error)) return {};
      if (!fs::is_directory(place, error))
        throw DataError(place,
                        "is a file of vectors, which contains no images; give those of both cameras with --images");
      images.push_back(in_case(place, frame));
    }
  return images;
}

void add_stereo_source(SourceFiles& sources, std::string const& name, std::string const& path) {
  bool const is_hdf5 = path.ends_with(".h5") || path.ends_with(".hdf5");
  sources.add(name, path, is_hdf5 ? SourceFiles::Holds::datasets : SourceFiles::Holds::bytes);
}

/// Reads the setup that a calibration stores, for the size of the images and the defaults of [correlate].
CaseSetup load_calibrated_setup(std::string const& calibration) {
  std::string const text = Hdf5Reader(calibration).attribute("setup");
  if (text.empty()) throw DataError(calibration, "contains no setup; run gladstone calibrate again");
  return load_case_setup(SetupDocument::from_text(text, calibration));
}

/// Adds an uncertainty to the settings for dewarped images if they have none and the method has none of its own: the
/// weights of the four equations and the uncertainty of the components depend on it.
CorrelationSettings choose_dewarped_settings(CorrelationSettings settings) {
  if (settings.uncertainty == "none" && !correlation_method(settings.method).tracks_dots)
    settings.uncertainty = "correlation_statistics";
  return settings;
}

/// Throws if a case was rendered through optical windows and its calibration without them, or the reverse: the lines of
/// sight of the calibration are not those of the images.
void require_same_windows(CaseSetup const& of_case, std::string const& place, std::string const& calibration) {
  if (Hdf5Reader(calibration).attribute("setup").empty()) return;
  std::size_t const own = of_case.setup.windows.size(),
                    calibrated = load_calibrated_setup(calibration).setup.windows.size();
  if (own == calibrated) return;
  throw DataError(
      calibration,
      fmt::format("was made through {} optical windows, but {} looks through {}, which displaces its lines of "
                  "sight; calibrate through the same windows",
                  calibrated, place, own));
}

/// Locates the files of an input, adds them to the sources, and reads them.
StereoInput read_stereo_input(StereoOptions const& options, std::size_t index, SourceFiles& sources) {
  std::string const& place = options.inputs[index];
  std::string const suffix = index == 0 ? "_a" : "_b";
  StereoInput input;
  if (!options.calibrations.empty()) {
    input.calibration = options.calibrations[index];
    require_input_file(input.calibration, "a calibration");
    add_stereo_source(sources, "calibration" + suffix, input.calibration);
    input.camera = read_calibrated_camera(input.calibration);
  }
  std::error_code error;
  std::string truth;
  if (fs::is_directory(place, error)) {
    require_case(place);
    std::string setup = in_case(place, case_file::setup);
    input.path = in_case(place, case_file::vectors);
    if (fs::exists(fs::path(place) / case_file::truth, error)) {
      truth = options.dewarp_images ? in_case(place, case_file::truth) : compared_files(place, "").truth;
      add_stereo_source(sources, "truth" + suffix, truth);
    } else if (!options.dewarp_images && !fs::exists(input.path, error)) {
      throw DataError(input.path, "does not exist; create it with: gladstone correlate " + place);
    }
    sources.add("", setup, SourceFiles::Holds::bytes);
    input.loaded = load_case_setup(setup, {});
    if (!input.calibration.empty()) require_same_windows(*input.loaded, place, input.calibration);
  } else {
    require_input_file(place, "a case folder or a file of vectors");
    if (options.dewarp_images)
      throw DataError(place,
                      "is a file of vectors, but --dewarp images requires the frames of cases; give case folders, "
                      "or remove the option");
    if (input.calibration.empty())
      throw DataError(place,
                      "is a file of vectors, which contains no camera; give the calibration.h5 of both cameras "
                      "with --calibration");
    input.path = place;
    input.loaded = load_calibrated_setup(input.calibration);
  }
  Setup const& setup = input.loaded->setup;
  if (input.calibration.empty()) input.camera = find_exact_camera(setup, place);
  if (!truth.empty() && setup.piv) input.truth = read_truth(truth);
  if (options.dewarp_images) {
    input.path = place;
    input.vectors.settings = choose_dewarped_settings(input.loaded->correlate);
    input.window_px = options.window_px.value_or(input.vectors.settings.window_px.back());
    return input;
  }
  add_stereo_source(sources, "vectors" + suffix, input.path);
  CompareOptions reading;
  reading.conventions = options.conventions;
  input.vectors = load_vectors(input.path, *input.loaded, input.truth ? &*input.truth : nullptr, reading);
  if (!input.vectors.report.empty()) spdlog::info("{}: {}", input.path, input.vectors.report);
  input.window_px = options.window_px.value_or(input.vectors.settings.window_px.back());
  if (!stereo::is_regular_grid(input.vectors.field))
    throw DataError(input.path,
                    "has no complete grid of vectors, in which invalid ones are marked or NaN; measure with a grid "
                    "(for tracking, correlate.tracking.output = \"grid\")");
  return input;
}

/// Correlates the frames of a case, dewarped onto a plane.
DisplacementField correlate_dewarped(StereoInput const& input, std::string const& place,
                                     std::array<Image<double>, 2> const& frames, stereo::Dewarping const& dewarping,
                                     Backend const& device) {
  CorrelationSettings const& settings = input.vectors.settings;
  if (!settings.preparation.files.empty())
    throw DataError(place,
                    "masks or subtracts images in [correlate], which do not fit dewarped frames; use --dewarp "
                    "vectors");
  std::string const problem = window_problem(settings, dewarping.grid.columns, dewarping.grid.rows);
  if (!problem.empty()) throw DataError(place, "dewarped: " + problem);
  auto const dewarp = [&](Image<double> const& frame) {
    return stereo::dewarp_image(frame, input.camera.camera, dewarping.plane, dewarping.grid);
  };
  HostFrames const dewarped(dewarp(frames[0]), dewarp(frames[1]));
  DisplacementField field = correlate_frames(dewarped, settings, device).field;
  if (!stereo::is_regular_grid(field))
    throw DataError(place, "has no complete grid of vectors; set correlate.tracking.output = \"grid\"");
  return field;
}

/// Dewarps the frames of both cases onto the part of the plane that they have in common, and correlates them.
stereo::Dewarping measure_dewarped(std::array<StereoInput*, 2> const& inputs, StereoOptions const& options,
                                   stereo::ObjectPlane const& plane, double pixel_size, SourceFiles& sources,
                                   Backend const& device) {
  std::array<std::array<Image<double>, 2>, 2> frames;
  std::array<std::array<int, 2>, 2> size{};
  for (std::size_t i = 0; i < 2; ++i) {
    char const* names[] = {case_file::reference, case_file::flow};
    for (std::size_t k = 0; k < 2; ++k) {
      std::string const file = in_case(options.inputs[i], names[k]);
      sources.add(fmt::format("{}_{}", k == 0 ? "reference" : "flow", i == 0 ? "a" : "b"), file,
                  SourceFiles::Holds::pixels);
      frames[i][k] = read_image(file);
    }
    size[i] = {frames[i][0].columns(), frames[i][0].rows()};
  }
  stereo::Dewarping dewarping{
      plane, stereo::find_common_view({&inputs[0]->camera.camera, &inputs[1]->camera.camera}, size, plane, pixel_size)};
  if (dewarping.grid.size() == 0)
    throw DataError(options.inputs[1],
                    fmt::format("and {} show no common part of the plane; check that the calibrations belong to these "
                                "cameras",
                                options.inputs[0]));
  for (std::size_t i = 0; i < 2; ++i)
    inputs[i]->vectors.field = correlate_dewarped(*inputs[i], options.inputs[i], frames[i], dewarping, device);
  return dewarping;
}

/// Throws for two cases whose particles differ.
void require_same_particles(StereoInput const& a, StereoInput const& b, StereoOptions const& options) {
  if (a.truth->position_m == b.truth->position_m && a.truth->particles.second_m == b.truth->particles.second_m) return;
  throw DataError(options.inputs[1],
                  fmt::format("shows other particles than {}; give two cameras of one rendering", options.inputs[0]));
}

void warn_of_displaced_sheet(StereoMeasurement& result) {
  constexpr double least_px = 0.5;
  stereo::SheetAlignment const& sheet = *result.given_sheet;
  double const disparity_px = sheet.disparity_px.front();
  if (!(disparity_px > least_px && stereo::is_significant(sheet))) return;
  result.warnings.push_back(fmt::format(
      "disparity of {:.2f} px between the images of the two cameras: the laser sheet is displaced by {:.3f} "
      "mm at X = Y = 0 from the assumed plane, so that the cameras measure at different places; use --align",
      disparity_px, (sheet.fit.plane.height - result.field.plane.height) / unit::mm));
}

void warn_of_rejected_vectors(StereoMeasurement& result) {
  constexpr double least_fraction = 0.01;
  auto const determined = std::count_if(result.field.nodes.begin(), result.field.nodes.end(),
                                        [](auto const& node) { return node.has_value(); });
  double const fraction = static_cast<double>(stereo::count_rejected(result.field)) / static_cast<double>(determined);
  if (fraction > least_fraction)
    result.warnings.push_back(fmt::format(
        "{:.1f} % of the vectors are rejected, because the two cameras disagree by more than the limit of the residual "
        "(--residual-limit): vectors of a camera are wrong (noise, too few particles), the laser sheet is not in the "
        "assumed plane (try --align), or the calibration has changed. Errors along the lines of sight's plane remain "
        "undetected: expect about as many further wrong vectors of u and w",
        100.0 * fraction));
  bool const any_sigma = std::any_of(result.field.nodes.begin(), result.field.nodes.end(),
                                     [](auto const& node) { return node && std::isfinite(node->covariance[0]); });
  if (!any_sigma)
    result.warnings.push_back(
        "the vectors have no uncertainty, so that the three components have none; correlate both cameras with an "
        "uncertainty method, e.g. --set correlate.uncertainty=correlation_statistics");
}

void warn_of_stereo_result(StereoMeasurement& result) {
  constexpr double least_angle = 20 * unit::degree, largest_ratio = 2.0;
  if (result.view_angle < least_angle)
    result.warnings.push_back(
        fmt::format("the angle between the views is {:.1f} degrees: the third component is {:.1f} times less certain "
                    "than the others; 60 to 90 degrees are best",
                    result.view_angle / unit::degree, 1.0 / std::tan(0.5 * result.view_angle)));
  constexpr double largest_disparity_px = 0.05;
  if (result.alignment && result.alignment->disparity_px.back() > largest_disparity_px)
    result.warnings.push_back(
        fmt::format("the position of the laser sheet has not converged: the residual disparity is {:.2f} px; use more "
                    "images, or start closer to the sheet with --sheet-z and --sheet-slope",
                    result.alignment->disparity_px.back()));
  if (result.given_sheet) warn_of_displaced_sheet(result);
  warn_of_rejected_vectors(result);
  double const ratio = compute_residual_ratio(result.field);
  if (ratio > largest_ratio)
    result.warnings.push_back(fmt::format(
        "the vectors of the two cameras disagree {:.1f} times more than their uncertainty explains: the "
        "laser sheet is not in the assumed plane (try --align), the calibration has changed, or vectors are "
        "wrong",
        ratio));
}

}  // namespace

std::array<ComponentErrors, 3> compute_stereo_errors(StereoMeasurement const& measurement) {
  constexpr Vec3d unknown{not_a_number, not_a_number, not_a_number};
  std::vector<Vec3d> error, sigma;
  std::vector<VectorStatus> status;
  for (std::size_t node = 0; node < measurement.field.nodes.size(); ++node) {
    auto const& vector = measurement.field.nodes[node];
    error.push_back(vector ? vector->displacement - measurement.truth[node] : unknown);
    sigma.push_back(vector ? vector->sigma() : unknown);
    status.push_back(vector ? vector->status : VectorStatus::invalid);
  }
  return compute_component_errors(error, sigma, status);
}

double compute_residual_ratio(stereo::StereoField const& field) {
  double squares = 0.0, count = 0.0;
  for (auto const& node : field.nodes) {
    if (!node || node->status != VectorStatus::valid || !std::isfinite(node->residual_ratio)) continue;
    squares += node->residual_ratio * node->residual_ratio;
    count += 1.0;
  }
  return count > 0 ? std::sqrt(squares / count) : not_a_number;
}

StereoMeasurement measure_stereo(StereoOptions const& options, Backend const& device) {
  check_stereo_options(options);
  StereoMeasurement result;
  result.sources.on_change("run gladstone stereo again");
  StereoInput a = read_stereo_input(options, 0, result.sources), b = read_stereo_input(options, 1, result.sources);
  if (a.truth && b.truth) require_same_particles(a, b, options);
  result.view_angle = stereo::find_view_angle(a.camera.camera, b.camera.camera, options.plane.point({}));
  constexpr double least_angle = 1 * unit::degree;
  if (!(result.view_angle > least_angle))
    throw DataError(options.inputs[1],
                    fmt::format("looks from the same direction as {} ({:.2f} degrees apart), so that the third "
                                "component is undetermined; give two cameras with different views",
                                options.inputs[0], result.view_angle / unit::degree));
  stop_point("reconstructing");
  stereo::ObjectPlane plane = options.plane;
  std::vector<std::string> const images = find_sheet_images(options);
  std::array<PinholeCamera const*, 2> const cameras{&a.camera.camera, &b.camera.camera};
  if (options.align) {
    result.alignment = align_sheet_of_files(images, cameras, plane, result.sources);
    plane = result.alignment->fit.plane;
  } else if (!images.empty()) {
    result.given_sheet = measure_disparity(images, cameras, plane, result.sources);
  }
  result.pixel_size =
      0.5 * (stereo::find_pixel_size(a.camera.camera, plane) + stereo::find_pixel_size(b.camera.camera, plane));
  stereo::StereoSettings settings;
  if (options.dewarp_images)
    settings.dewarping = measure_dewarped({&a, &b}, options, plane, result.pixel_size, result.sources, device);
  settings.spacing = options.spacing;
  settings.window_a_px = a.window_px;
  settings.window_b_px = b.window_px;
  result.field = stereo::reconstruct(a.camera, a.vectors.field, b.camera, b.vectors.field, plane, settings);
  if (result.field.grid.size() == 0)
    throw DataError(options.inputs[1], fmt::format("and {} have no vectors in common on the plane; check that the "
                                                   "calibrations belong to these cameras, and --spacing",
                                                   options.inputs[0]));
  bool const any = std::any_of(result.field.nodes.begin(), result.field.nodes.end(),
                               [](auto const& node) { return node.has_value(); });
  if (!any)
    throw NoValidVector(options.inputs[1],
                        fmt::format("and {} have no valid vectors at the same place", options.inputs[0]));
  result.field = stereo::reject_large_residuals(std::move(result.field), options.residual_limit);
  if (a.truth && b.truth) {
    double const per_metre = 1.0 / result.pixel_size;
    Vec2d const scale = options.dewarp_images ? Vec2d{per_metre, per_metre}
                                              : find_plane_scale({&a.camera.camera, &b.camera.camera}, plane);
    result.truth = compute_stereo_truth({&*a.truth, &*b.truth}, scale, result.field.grid, a.vectors.settings);
  }
  result.vectors = {a.path, b.path};
  result.calibrations = {a.calibration, b.calibration};
  result.window_px = {a.window_px, b.window_px};
  result.setup = a.loaded->document.resolved();
  result.seed = a.loaded->setup.render.seed;
  warn_of_stereo_result(result);
  for (std::string const& warning : result.warnings) spdlog::warn("{}", warning);
  return result;
}

}  // namespace gladstone
