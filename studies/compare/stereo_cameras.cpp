#include "studies/compare/stereo_cameras.h"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "render/base/error.h"
#include "render/files/hdf5_file.h"
#include "render/scene/build_camera.h"
#include "render/scene/calibration_planes.h"
#include "studies/case/warning_log.h"

namespace gladstone::inline compare {
namespace {

/// Reads a dataset of a calibration. @throws DataError if it does not exist or has another size
std::vector<double> read_parameters(Hdf5Reader const& file, std::string const& path, char const* dataset,
                                    std::size_t count) {
  std::vector<double> values = file.has(dataset) ? file.read(dataset) : std::vector<double>{};
  bool const complete = values.size() == count &&
                        std::all_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
  if (!complete)
    throw DataError(
        ErrorCode::missing_content, path,
        fmt::format("has no {} of {} finite numbers; give a calibration.h5 of gladstone calibrate", dataset, count));
  return values;
}

double root_mean_square(std::vector<double> const& values) {
  double sum = 0.0;
  for (double const value : values) sum += value * value;
  return std::sqrt(sum / static_cast<double>(values.size()));
}

void warn_of_other_optics(Hdf5Reader const& file, std::string const& path) {
  constexpr double least_px = 0.05, ratio = 3.0;
  if (!file.has("/dots/pinhole_residual_px") || !file.has("/dots/soloff_residual_px")) return;
  double const pinhole = root_mean_square(file.read("/dots/pinhole_residual_px"));
  double const polynomial = root_mean_square(file.read("/dots/soloff_residual_px"));
  if (!(pinhole > least_px && pinhole > ratio * polynomial)) return;
  log_warning({WarningCode::low_accuracy, path,
               fmt::format("the dots deviate from the pinhole camera by {:.3g} px rms, but from the polynomial by "
                           "{:.3g} px only: the camera is not a pinhole camera (a window?), so that the components "
                           "have systematic errors; calibrate without the window, or use the uncertainties with care",
                           pinhole, polynomial)});
}

}  // namespace

stereo::CalibratedCamera read_calibrated_camera(std::string const& path) {
  Hdf5Reader const file(path);
  if (file.attribute("filetype") != "gladstone calibration")
    throw DataError(ErrorCode::wrong_format, path,
                    "is not a calibration; give the calibration.h5 that gladstone calibrate writes");
  std::vector<double> const matrix = read_parameters(file, path, "/pinhole/camera_matrix", 9),
                            brown = read_parameters(file, path, "/pinhole/distortion", 4),
                            r = read_parameters(file, path, "/pinhole/rvec", 3),
                            t = read_parameters(file, path, "/pinhole/tvec", 3);
  stereo::CalibratedCamera calibrated;
  calibrated.camera = {{matrix[0], matrix[4], matrix[2], matrix[5], brown[0], brown[1], brown[2], brown[3], r[0], r[1],
                        r[2], t[0], t[1], t[2]}};
  calibrated.covariance =
      read_parameters(file, path, "/pinhole/covariance", PinholeCamera::count * PinholeCamera::count);
  warn_of_other_optics(file, path);
  return calibrated;
}

stereo::CalibratedCamera find_exact_camera(Setup const& setup, std::string const& name) {
  std::optional<Pinhole> const pinhole = equivalent_pinhole(setup, build_camera(setup));
  if (!pinhole)
    throw DataError(
        ErrorCode::unsupported, name,
        "has a camera that is not an exact pinhole camera (a prescription, windows or other optical elements, or "
        "distortion on a tilted sensor); calibrate both cameras and give their calibration.h5 with --calibration");
  Eigen::Matrix3d rotation;
  for (int i = 0; i < 3; ++i) {
    Vec3d const row = pinhole->rows[static_cast<std::size_t>(i)];
    rotation.row(i) << row.x, row.y, row.z;
  }
  Eigen::AngleAxisd const turn(rotation);
  Eigen::Vector3d const r = turn.angle() * turn.axis();
  BrownDistortion<double> const& brown = pinhole->brown;
  Vec3d const t = pinhole->translation;
  return {{{pinhole->fx, pinhole->fy, pinhole->cx, pinhole->cy, brown.k1, brown.k2, brown.p1, brown.p2, r.x(), r.y(),
            r.z(), t.x, t.y, t.z}},
          {}};
}

}  // namespace gladstone::inline compare
