#pragma once

#include <limits>

#include "render/base/host_device.h"
#include "render/base/vec.h"

namespace gladstone::inline tomography {

/// Straight line of sight through a volume, and the weight of the density along it.
///
/// In BOS, the displacement of a dot is proportional to the integral of l(s) grad(rho), where l(s) is the distance
/// between the dot and the gas at s. Sight lines meet in the pupil, so that their distance from one another is
/// proportional to the distance c(s) from the pupil. The displacement is therefore the gradient of a projection in
/// which the density has the weight l(s) / c(s). This weight accounts for the depth of a thick medium; parallel lines
/// have the weight 1.
struct SightLine {
  /// Position of the dot; for parallel lines, any point of the line [m].
  Vec3d origin{};
  Vec3d direction{};  ///< unit vector towards the camera [1]
  /// Distance from dot to pupil [m]; infinite: parallel lines.
  double pupil_distance = std::numeric_limits<double>::infinity();
  double scale = 1.0;  ///< factor that makes the weight 1 in the middle of the medium, c / l [1]

  GLADSTONE_HD bool is_parallel() const { return !(pupil_distance < std::numeric_limits<double>::max()); }
  /// Returns the weight at the distance s from the origin [1].
  GLADSTONE_HD double weight(double s) const { return is_parallel() ? 1.0 : scale * s / (pupil_distance - s); }
};

}  // namespace gladstone::inline tomography
