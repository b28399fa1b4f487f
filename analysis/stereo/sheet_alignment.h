#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "analysis/correlation/correlation_settings.h"
#include "analysis/stereo/dewarping.h"
#include "analysis/stereo/stereo_camera.h"
#include "render/base/image.h"

namespace gladstone::inline stereo {

/// Images of the two cameras, recorded at the same time.
using SimultaneousImages = std::array<Image<double>, 2>;

/// Plane fitted to points of the laser sheet.
struct FittedPlane {
  ObjectPlane plane;
  double scatter = 0.0;    ///< rms distance of the points from the plane, along z [m]
  std::size_t points = 0;  ///< number of points that were not excluded
  std::size_t outliers = 0;
  double freedom = 0.0;  ///< degrees of freedom of the scatter: independent points minus three parameters, at least 1
  double height_sigma = 0.0;  ///< standard uncertainty of ObjectPlane::height [m]
  Vec2d slope_sigma{};        ///< standard uncertainties of ObjectPlane::slope [1]
};

/// Fits a plane by least squares and excludes points farther from it than three robust standard deviations, repeatedly.
/// The uncertainties follow from the scatter and the number of independent points.
/// @param redundancy  ratio of the number of points to the number of independent points, see find_redundancy() [1]
/// @return nullopt for fewer than four points or points on one line
std::optional<FittedPlane> fit_object_plane(std::vector<Vec3d> const& points, double redundancy = 1.0);

/// Computes the factor by which the variance of the mean over a row of vectors exceeds that of independent vectors,
/// because the errors of windows that overlap by a fraction o have the correlation o. For an overlap of 0.5 and n
/// vectors, the factor is 2 - 1/n.
double find_redundancy(int vectors, double overlap);

/// Finds the position of a point that appears at `in_a` on the plane to camera a and at `in_b` to camera b [m]: the
/// middle of the shortest connection between the two lines of sight.
Vec3d triangulate(PinholeCamera const& a, Vec2d in_a, PinholeCamera const& b, Vec2d in_b, ObjectPlane const& plane);

/// Laser sheet found by align_sheet().
struct SheetAlignment {
  FittedPlane fit;
  double pixel_size = 0.0;  ///< size of a pixel of the dewarped images [m]
  /// Disparity of the fitted plane in the images dewarped onto the plane of each iteration, rms over the vectors [px].
  /// The first value is the initial misalignment, the last one the residual.
  std::vector<double> disparity_px;
  /// Rms difference between the measured disparities and those of the fitted plane in the last iteration [px].
  double scatter_px = 0.0;
  /// Standard uncertainty of the disparity of the fitted plane, rms over the vectors, from the scatter of the points
  /// along z and their number; last iteration [px].
  double disparity_sigma_px = 0.0;

  /// Returns whether the last iteration changed the plane by less than 0.05 px, or by less than its uncertainty.
  bool has_converged() const { return disparity_px.back() <= std::max(0.05, disparity_sigma_px); }
  /// Returns whether the disparity of the initial plane exceeds three times its standard uncertainty. Otherwise the
  /// images do not prove that the laser sheet deviates from this plane.
  bool is_significant() const { return disparity_px.front() > 3.0 * disparity_sigma_px; }
};

/// Determines the plane of the laser sheet from the disparity between images of two cameras (Wieneke, Exp. Fluids 39
/// (2005) 267). Simultaneous images of the two cameras are dewarped onto the assumed plane and correlated, over all
/// pairs together (ensemble). If the sheet differs from the assumed plane, a particle appears at different positions on
/// this plane to the two cameras. The intersections of the lines of sight are points of the sheet, through which a new
/// plane is fitted. This is repeated until the disparity falls below 0.005 px.
/// @param plane  initial plane; disparities of up to a quarter of the first window can be measured
/// @param settings  settings of the correlation of the dewarped images; `uncertainty` must be "none"
/// @param max_iterations  maximum number of iterations; 1: only measures the disparity of the assumed plane
/// @throws DataError if the views do not overlap, a window does not fit, or too few vectors are valid
SheetAlignment align_sheet(std::array<PinholeCamera const*, 2> const& cameras,
                           std::vector<SimultaneousImages> const& images, ObjectPlane plane,
                           CorrelationSettings const& settings, int max_iterations = 8);

}  // namespace gladstone::inline stereo
