#include "studies/compare/stereo.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <utility>

#include "analysis/preparation/frame_preparation.h"
#include "analysis/stereo/interpolated_field.h"
#include "analysis/stereo/residual_validation.h"
#include "render/base/error.h"
#include "render/base/frame_pair.h"
#include "render/base/nearest_name.h"
#include "render/base/not_a_number.h"
#include "render/base/units.h"
#include "render/files/stop_point.h"
#include "render/scene/read_setup_document.h"
#include "studies/case/cameras.h"
#include "studies/case/warning_log.h"
#include "studies/compare/correlate.h"
#include "studies/compare/stereo_alignment.h"
#include "studies/compare/stereo_input.h"
#include "studies/compare/stereo_scores.h"
#include "studies/compare/stereo_truth.h"
#include "studies/compare/stereo_warnings.h"

namespace gladstone::inline compare {
namespace {

namespace fs = std::filesystem;

void check_stereo_options(StereoOptions const& options) {
  std::vector<SetupProblem> problems;
  if (!options.calibrations.empty() && options.calibrations.size() != 2)
    problems.push_back({"--calibration",
                        fmt::format("expected two files, one for each camera, got {}", options.calibrations.size()), "",
                        ErrorCode::arguments});
  stereo::ObjectPlane const& plane = options.plane;
  if (!std::isfinite(plane.height)) problems.push_back({"--sheet-z", "expected a finite number"});
  if (!is_finite(plane.slope)) problems.push_back({"--sheet-slope", "expected two finite numbers"});
  if (!(options.spacing >= 0.0 && std::isfinite(options.spacing)))
    problems.push_back({"--spacing", "expected a positive distance in mm"});
  if (options.window_px && !(*options.window_px >= 0.0 && std::isfinite(*options.window_px)))
    problems.push_back({"--window", "expected a size in px, 0 for independent errors"});
  if (options.images.size() % 2 != 0)
    problems.push_back({"--images",
                        fmt::format("expected images of the first and of the second camera in turn, got an "
                                    "odd number ({})",
                                    options.images.size()),
                        "", ErrorCode::arguments});
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
        throw DataError(ErrorCode::wrong_format, place,
                        "is a file of vectors, which contains no images; give those of both cameras with --images");
      images.push_back(in_case(place, frame));
    }
  return images;
}

/// Correlates the frames of a case, dewarped onto a plane. Masks and preprocessing steps are applied to the frames as
/// they were recorded: the windows leave out a pixel of the plane if one of the pixels that it is interpolated from is
/// masked.
DisplacementField correlate_dewarped(StereoInput const& input, std::string const& place,
                                     FramePair<double> const& frames, stereo::Dewarping const& dewarping,
                                     Backend const& device) {
  CorrelationSettings settings = input.vectors.settings;
  HostFrames const prepared =
      prepare_frames(HostFrames(frames), std::exchange(settings.preparation, FramePreparation{}));
  std::string const problem = window_problem(settings, dewarping.grid.columns, dewarping.grid.rows);
  if (!problem.empty()) throw DataError(ErrorCode::wrong_shape, place, "dewarped: " + problem);
  auto const dewarp = [&](Image<double> const& frame) {
    return stereo::dewarp_image(frame, input.camera.camera, dewarping.plane, dewarping.grid);
  };
  HostFrames const dewarped(dewarp(prepared.reference()), dewarp(prepared.flow()));
  DisplacementField field = correlate_frames(dewarped, settings, device).field;
  if (field.columns == 1 || field.rows == 1)
    throw DataError(ErrorCode::wrong_shape, place,
                    fmt::format("shows a part of the sheet in common with the other camera that is too small ({} x {} "
                                "vectors); use smaller windows, or --dewarp vectors",
                                field.columns, field.rows));
  if (!stereo::is_regular_grid(field))
    throw DataError(ErrorCode::wrong_shape, place,
                    "has no complete grid of vectors; set correlate.tracking.output = \"grid\"");
  return field;
}

/// Throws if the frames of a case differ in size.
void require_equal_sizes(FramePair<double> const& frames, std::string const& place) {
  auto const& [reference, flow] = frames;
  if (reference.columns() == flow.columns() && reference.rows() == flow.rows()) return;
  throw DataError(ErrorCode::wrong_shape, in_case(place, case_file::flow),
                  fmt::format("is {} x {} px but {} is {} x {} (both frames must have one size)", flow.columns(),
                              flow.rows(), case_file::reference, reference.columns(), reference.rows()));
}

/// Dewarps the frames of both cases onto the part of the plane that they have in common, and correlates them.
/// @param known  frames A of both cases, then frames B, if they have been read; else empty
stereo::Dewarping measure_dewarped(std::array<StereoInput*, 2> const& inputs, StereoOptions const& options,
                                   std::vector<stereo::SimultaneousImages> known, stereo::ObjectPlane const& plane,
                                   double pixel_size, SourceFiles& sources, Backend const& device) {
  std::array<FramePair<double>, 2> frames;
  std::array<std::array<int, 2>, 2> size{};
  for (std::size_t i = 0; i < 2; ++i) {
    char const* names[] = {case_file::reference, case_file::flow};
    for (std::size_t k = 0; k < 2; ++k) {
      std::string const file = in_case(options.inputs[i], names[k]);
      std::string const name = fmt::format("{}_{}", k == 0 ? "reference" : "flow", i == 0 ? "a" : "b");
      Image<double>& frame = k == 0 ? frames[i].reference : frames[i].flow;
      if (known.empty()) {
        frame = sources.add_image(name, file);
      } else {
        sources.add(name, file, SourceFiles::Holds::pixels);
        frame = std::move(known[k][i]);
      }
    }
    require_equal_sizes(frames[i], options.inputs[i]);
    std::size_t number = 0;
    for (std::string const& file : inputs[i]->vectors.settings.preparation.files)
      sources.add(fmt::format("preparation_{}_{}", i == 0 ? "a" : "b", ++number), file, SourceFiles::Holds::pixels);
    size[i] = {frames[i].reference.columns(), frames[i].reference.rows()};
  }
  stereo::Dewarping dewarping{
      plane, stereo::find_common_view({&inputs[0]->camera.camera, &inputs[1]->camera.camera}, size, plane, pixel_size)};
  if (dewarping.grid.size() == 0)
    throw DataError(ErrorCode::inconsistent, options.inputs[1],
                    fmt::format("shows no part of the plane that {} shows, too; check that the calibrations belong to "
                                "these cameras, and --sheet-z",
                                options.inputs[0]));
  for (std::size_t i = 0; i < 2; ++i)
    inputs[i]->vectors.field = correlate_dewarped(*inputs[i], options.inputs[i], frames[i], dewarping, device);
  return dewarping;
}

/// Throws for two cases whose particles differ.
void require_same_particles(StereoInput const& a, StereoInput const& b, StereoOptions const& options) {
  if (a.truth->position_m == b.truth->position_m && a.truth->particles.second_m == b.truth->particles.second_m) return;
  throw DataError(ErrorCode::inconsistent, options.inputs[1],
                  fmt::format("shows other particles than {}; give two cameras of one rendering", options.inputs[0]));
}

}  // namespace

std::array<std::string, 2> find_stereo_inputs(std::array<std::string, 2> const& inputs) {
  std::string const& folder = inputs[0];
  if (!inputs[1].empty()) return inputs;
  std::error_code error;
  std::vector<std::string> names;
  if (fs::is_directory(folder, error)) {
    require_case(folder);
    names = camera_names(read_setup_document((fs::path(folder) / case_file::setup).string()));
  }
  if (names.size() != 2)
    throw DataError(ErrorCode::wrong_format, folder,
                    fmt::format("is not the folder of a case with two cameras{}; give the cases or the vectors "
                                "of two cameras",
                                names.empty() ? "" : " (it has " + quoted_list(names) + ")"));
  return {(fs::path(folder) / names[0]).string(), (fs::path(folder) / names[1]).string()};
}

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

StereoMeasurement measure_stereo(StereoOptions options, Backend const& device) {
  check_stereo_options(options);
  options.inputs = find_stereo_inputs(options.inputs);
  StereoMeasurement result;
  result.sources.on_change("run gladstone stereo again");
  StereoInput a = read_stereo_input(options, 0, result.sources), b = read_stereo_input(options, 1, result.sources);
  if (a.truth && b.truth) require_same_particles(a, b, options);
  result.view_angle = stereo::find_view_angle(a.camera.camera, b.camera.camera, options.plane.point({}));
  constexpr double least_angle = 1 * unit::degree;
  if (!(result.view_angle > least_angle))
    throw DataError(ErrorCode::undetermined, options.inputs[1],
                    fmt::format("looks from the same direction as {} ({:.2f} degrees apart), so that the third "
                                "component is undetermined; give two cameras with different views",
                                options.inputs[0], result.view_angle / unit::degree));
  stop_point("reconstructing");
  stereo::ObjectPlane plane = options.plane;
  std::vector<stereo::SimultaneousImages> images = read_simultaneous_images(find_sheet_images(options), result.sources);
  std::array<PinholeCamera const*, 2> const cameras{&a.camera.camera, &b.camera.camera};
  if (options.align) {
    result.alignment = align_sheet_of_images(images, cameras, plane);
    if (result.is_aligned()) plane = result.alignment->fit.plane;
  } else if (!images.empty()) {
    result.given_sheet = measure_disparity(images, cameras, plane);
  }
  result.pixel_size =
      0.5 * (stereo::find_pixel_size(a.camera.camera, plane) + stereo::find_pixel_size(b.camera.camera, plane));
  stereo::StereoSettings settings;
  if (!options.images.empty()) images.clear();  // which are not the frames of the cases
  if (options.dewarp_images)
    settings.dewarping =
        measure_dewarped({&a, &b}, options, std::move(images), plane, result.pixel_size, result.sources, device);
  settings.spacing = options.spacing;
  settings.window_a_px = a.window_px;
  settings.window_b_px = b.window_px;
  result.field = stereo::reconstruct(a.camera, a.vectors.field, b.camera, b.vectors.field, plane, settings);
  if (result.field.grid.size() == 0)
    throw DataError(ErrorCode::undetermined, options.inputs[1],
                    fmt::format("has no vectors in common with {} on the plane; check that the "
                                "calibrations belong to these cameras, --sheet-z and --spacing",
                                options.inputs[0]));
  bool const any = std::any_of(result.field.nodes.begin(), result.field.nodes.end(),
                               [](auto const& node) { return node.has_value(); });
  if (!any)
    throw DataError(ErrorCode::no_valid_vector, options.inputs[1],
                    fmt::format("has no valid vectors where {} has some", options.inputs[0]));
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
  result.warnings = find_stereo_warnings(result);
  log_warnings(result.warnings);
  return result;
}

}  // namespace gladstone::inline compare
