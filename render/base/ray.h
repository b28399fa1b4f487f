#pragma once

#include "render/base/host_device.h"
#include "render/base/vec.h"

namespace gladstone::inline base {

/// Outcome of tracing a ray. Rays that fail are counted and reported; no exception is thrown.
enum class RayStatus : int {
  alive,                      ///< reached the sensor plane inside the sensor's area
  missed_sensor,              ///< reached the sensor plane outside the sensor's area; included in the ground truth, not
                              ///< in the image
  vignetted,                  ///< blocked by an aperture
  total_internal_reflection,  ///< total internal reflection at an interface to a medium of lower index
  lost_in_medium,             ///< turned back or trapped inside the refractive medium
  missed_lens,                ///< travels parallel to or away from the lens
};
inline constexpr int ray_status_count = 6;

/// Name of a status in files and reports.
constexpr char const* to_string(RayStatus status) {
  constexpr char const* words[ray_status_count] = {
      "alive", "missed_sensor", "vignetted", "total_internal_reflection", "lost_in_medium", "missed_lens"};
  return words[static_cast<int>(status)];
}

/// Straight ray in the world frame.
template <class T>
struct Ray {
  Vec3<T> position;   ///< starting point [m]
  Vec3<T> direction;  ///< unit vector
};

}  // namespace gladstone::inline base
