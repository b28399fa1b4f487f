#pragma once

#include <array>
#include <optional>
#include <vector>

#include "analysis/calibration/calibration_points.h"

namespace gladstone::inline calibration {

/// Deviation of the calibration plate from its nominal placement, in which the plate is translated along its own normal
/// with its centre dot on the Z axis. The plate defines the world frame: X and Y lie in the plate, Z is its normal.
struct PlatePlacement {
  Vec2d drift{};  ///< X and Y components of the unit vector along which the plate was translated [1]
  std::vector<std::array<int, 2>> moved;  ///< offset of the dot indices of each plane (column, row); empty: none
  std::vector<std::size_t> order;         ///< index of the plane that each image shows; empty: image k shows plane k
};

/// Dots of all planes with their grid indices.
struct PlateDots {
  std::vector<Vec2d> pixel;
  std::vector<std::array<int, 2>> index;  ///< column and row relative to the centre dot
  std::vector<std::size_t> plane_of;
  std::vector<double> z;  ///< distance by which each plane was translated [m]
  double spacing = 0;     ///< distance between neighbouring dots [m]
  double dot_radius = 0;  ///< radius of the dots [m]
  CalibratedLens lens;

  CalibrationPoints points(PlatePlacement const& placement = {}) const;
};

/// Finds an order of the images in which a pinhole camera without distortion fits the dots at least five times better
/// than in the given order.
/// @return nullopt if no such order exists, or for fewer than three or more than six planes
std::optional<std::vector<std::size_t>> find_image_order(PlateDots const& dots);

/// Finds the planes whose centre dots were misidentified by whole columns or rows. Searches the index offsets that
/// reduce the residual of a pinhole camera without distortion at least five-fold. The offsets of one plane, or of two
/// planes at once, are changed until the residual no longer decreases. Offsets proportional to Z do not change the
/// residual; they are determined from the principal point, as in find_drift(). An offset common to all planes does not
/// affect the camera; the smallest offsets are returned.
/// @return nullopt if no offsets improve the fit sufficiently
std::optional<PlatePlacement> find_misidentified_centres(PlateDots const& dots, Vec2d principal_point_px);

/// Determines the drift of a plate that was not translated along its normal, from the position of the principal point,
/// which a drift d shifts by f d. If index offsets by a whole number of spacings from plane to plane bring the
/// principal point to the expected one, the centre dots were misidentified and the result contains these offsets
/// instead. Such offsets do not change the distance between the planes, whereas a drift reduces this distance.
/// @return nullopt if no drift brings the principal point to within 1 px of the expected one
std::optional<PlatePlacement> find_drift(PlateDots const& dots, Vec2d principal_point_px);

}  // namespace gladstone::inline calibration
