#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "analysis/correlation/correlation_settings.h"
#include "analysis/stereo/dewarping.h"
#include "analysis/stereo/stereo_camera.h"
#include "render/base/image.h"

namespace gladstone::stereo {

/// Images of the two cameras, recorded at the same time.
using SimultaneousImages = std::array<Image<double>, 2>;

/// Plane fitted to points of the laser sheet.
struct FittedPlane {
  ObjectPlane plane;
  double scatter = 0.0;    ///< rms distance of the points from the plane, along z [m]
  std::size_t points = 0;  ///< number of points without the excluded ones
  std::size_t outliers = 0;
};

/// Fits a plane by least squares and excludes points farther from it than three robust standard deviations, repeatedly.
/// @return nullopt for fewer than four points or points on one line
std::optional<FittedPlane> fit_object_plane(std::vector<Vec3d> const& points);

/// Finds the point that two cameras see at different places of a plane: the middle of the shortest connection of the
/// lines of sight through the points of the plane at `in_a` and `in_b` [m].
Vec3d triangulate(PinholeCamera const& a, Vec2d in_a, PinholeCamera const& b, Vec2d in_b, ObjectPlane const& plane);

/// Laser sheet found by align_sheet().
struct SheetAlignment {
  FittedPlane fit;
  double pixel_size = 0.0;  ///< of the dewarped images [m]
  /// Disparity of the fitted plane in the images dewarped onto the plane of each iteration, rms over the vectors [px]:
  /// first the misalignment, last the residual.
  std::vector<double> disparity_px;
  double scatter_px = 0.0;  ///< rms of the measured disparities about those of the fitted plane, last iteration [px]
};

/// Determines the plane of the laser sheet from the disparity between images of two cameras (Wieneke, Exp. Fluids 39
/// (2005) 267). Images of the same time are dewarped onto the assumed plane and correlated, over all pairs together
/// (ensemble). If the sheet lies elsewhere, both cameras see a particle at different places of the assumed plane; the
/// intersections of the lines of sight are points of the sheet, through which a new plane is fitted. This is repeated
/// until the disparity falls below 0.005 px.
/// @param plane     first assumption; disparities up to a quarter of the first window can be measured
/// @param settings  of the correlation of dewarped images; uncertainty "none"
/// @param max_iterations  1: only measures the disparity of the assumed plane
/// @throws DataError if the views do not overlap, a window does not fit, or too few vectors are valid
SheetAlignment align_sheet(std::array<PinholeCamera const*, 2> const& cameras,
                           std::vector<SimultaneousImages> const& images, ObjectPlane plane,
                           CorrelationSettings const& settings, int max_iterations = 8);

/// Returns whether the disparity of the first iteration exceeds three times the scatter of the measured disparities
/// about those of the fitted plane. Below that, a single window does not determine the displacement of the sheet, and
/// in thick sheets or with noise the fitted plane follows the few particles that dominate the correlation.
bool is_significant(SheetAlignment const& alignment);

}  // namespace gladstone::stereo
