#pragma once

#include <limits>

#include "render/base/host_device.h"
#include "render/base/vec.h"

namespace gladstone::tomography {

/// Straight line of sight through a volume, and the weight of the density along it.
///
/// BOS displaces a dot by the integral of l(s) grad(rho), with the distance l(s) between dot and gas. Sight lines that
/// meet in the pupil at the distance c(s) spread like c(s). The displacement is therefore the gradient of a projection
/// in which the density has the weight l(s) / c(s). This weight accounts for the depth of a thick medium; parallel
/// lines have the weight 1.
struct SightLine {
  Vec3d origin{};                                                   ///< dot; any point of a parallel line [m]
  Vec3d direction{};                                                ///< unit vector towards the camera
  double pupil_distance = std::numeric_limits<double>::infinity();  ///< dot to pupil [m]; infinite: parallel lines
  double scale = 1.0;  ///< factor that makes the weight 1 in the middle of the medium, c / l [1]

  GLADSTONE_HD bool is_parallel() const { return !(pupil_distance < std::numeric_limits<double>::max()); }
  /// Weight at the distance s from the origin [1].
  GLADSTONE_HD double weight(double s) const { return is_parallel() ? 1.0 : scale * s / (pupil_distance - s); }
};

}  // namespace gladstone::tomography
