#include "studies/compare/stereo_input.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "analysis/correlation/correlation_methods.h"
#include "analysis/stereo/interpolated_field.h"
#include "render/base/error.h"
#include "render/base/units.h"
#include "render/files/hdf5_file.h"
#include "render/files/input_file.h"
#include "studies/case/case_kind.h"
#include "studies/case/truth_file.h"
#include "studies/compare/compared_files.h"
#include "studies/compare/stereo_cameras.h"

namespace gladstone::inline compare {
namespace {

namespace fs = std::filesystem;

/// Reads the setup that a calibration stores, for the size of the images and the defaults of [correlate].
CaseSetup load_calibrated_setup(std::string const& calibration) {
  std::string const text = Hdf5Reader(calibration).attribute("setup");
  if (text.empty())
    throw DataError(ErrorCode::missing_content, calibration, "contains no setup; run gladstone calibrate again");
  return load_case_setup(SetupDocument::from_text(text, calibration));
}

/// Adds an uncertainty method to the settings for dewarped images if they select none and the correlation method does
/// not estimate the uncertainty itself: the weights of the four equations and the uncertainty of the components depend
/// on it.
CorrelationSettings choose_dewarped_settings(CorrelationSettings settings) {
  if (!settings.estimates_uncertainty() && !correlation_method(settings.method).tracks_dots)
    settings.uncertainty = "correlation_statistics";
  return settings;
}

/// Throws if a case was rendered through optical elements and its calibration without them, or the reverse: the lines
/// of sight of the calibration are not those of the images.
void require_same_elements(CaseSetup const& of_case, std::string const& place, std::string const& calibration) {
  if (Hdf5Reader(calibration).attribute("setup").empty()) return;
  auto const count = [](Setup const& setup) {
    return std::count_if(setup.elements.begin(), setup.elements.end(),
                         [](OpticalElement const& element) { return element.side() != ElementSide::image_plane; });
  };
  auto const own = count(of_case.setup), calibrated = count(load_calibrated_setup(calibration).setup);
  if (own == calibrated) return;
  throw DataError(
      ErrorCode::inconsistent, calibration,
      fmt::format("was made through {} optical elements, but the camera of {} looks through {} (elements displace "
                  "the lines of sight); calibrate through the same elements",
                  calibrated, place, own));
}

/// Throws if the camera of a calibration is elsewhere than that of the rendered case. Exchanged calibrations of two
/// symmetric cameras would give a third component of the wrong sign without any residual.
void require_same_view(CaseSetup const& of_case, std::string const& place, PinholeCamera const& camera,
                       std::string const& calibration) {
  // tolerance: an alignment of the sheet changes the viewing direction by a few degrees
  constexpr double largest_angle = 10 * unit::degree;
  Vec3d const own = of_case.setup.camera_pose().origin, calibrated = stereo::find_pinhole(camera);
  double const angle = std::atan2(length(cross(own, calibrated)), dot(own, calibrated));
  if (angle <= largest_angle) return;
  throw DataError(
      ErrorCode::inconsistent, calibration,
      fmt::format("describes a camera at ({:.4g}, {:.4g}, {:.4g}) mm, but that of {} is at ({:.4g}, {:.4g}, "
                  "{:.4g}) mm; give the calibrations in the order of the cases",
                  1e3 * calibrated.x, 1e3 * calibrated.y, 1e3 * calibrated.z, place, 1e3 * own.x, 1e3 * own.y,
                  1e3 * own.z));
}

}  // namespace

StereoInput read_stereo_input(StereoOptions const& options, std::size_t index, SourceFiles& sources) {
  std::string const& place = options.inputs[index];
  std::string const suffix = index == 0 ? "_a" : "_b";
  StereoInput input;
  if (!options.calibrations.empty()) {
    input.calibration = options.calibrations[index];
    require_input_file(input.calibration, "a calibration");
    sources.add("calibration" + suffix, input.calibration);
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
      sources.add("truth" + suffix, truth);
    } else if (!options.dewarp_images && !fs::exists(input.path, error)) {
      throw DataError(ErrorCode::missing_file, input.path,
                      "does not exist; create it with: gladstone correlate " + place);
    }
    sources.add("", setup, SourceFiles::Holds::bytes);
    input.loaded = load_case_setup(setup, {});
    require_experiment(input.loaded->setup, piv_experiment, place,
                       "is not a PIV case (its vectors are not the displacement of particles); give two cameras of a "
                       "PIV rendering");
    if (!input.calibration.empty()) {
      require_same_elements(*input.loaded, place, input.calibration);
      require_same_view(*input.loaded, place, input.camera.camera, input.calibration);
    }
  } else {
    require_input_file(place, "a case folder or a file of vectors");
    if (options.dewarp_images)
      throw DataError(ErrorCode::wrong_format, place,
                      "is a file of vectors, but --dewarp images requires the frames of cases; give case folders, "
                      "or remove the option");
    if (input.calibration.empty())
      throw DataError(ErrorCode::wrong_format, place,
                      "is a file of vectors, which contains no camera; give the calibration.h5 of both cameras "
                      "with --calibration");
    input.path = place;
    input.loaded = load_calibrated_setup(input.calibration);
  }
  Setup const& setup = input.loaded->setup;
  if (input.calibration.empty()) input.camera = find_exact_camera(setup, place);
  if (!truth.empty()) input.truth = read_truth(truth);
  if (options.dewarp_images) {
    input.path = place;
    input.vectors.settings = choose_dewarped_settings(input.loaded->correlate);
    input.window_px = options.window_px.value_or(input.vectors.settings.window_px.back());
    return input;
  }
  sources.add("vectors" + suffix, input.path);
  CompareOptions reading;
  reading.conventions = options.conventions;
  input.vectors = load_vectors(input.path, *input.loaded, input.truth ? &*input.truth : nullptr, reading);
  if (!input.vectors.report.empty()) spdlog::info("{}: {}", input.path, input.vectors.report);
  input.window_px = options.window_px.value_or(input.vectors.settings.window_px.back());
  if (!stereo::is_regular_grid(input.vectors.field))
    throw DataError(ErrorCode::wrong_shape, input.path,
                    "has no complete grid of vectors, in which invalid ones are marked or NaN; measure with a grid "
                    "(for tracking, correlate.tracking.output = \"grid\")");
  return input;
}

}  // namespace gladstone::inline compare
