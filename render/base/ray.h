#pragma once

#include "render/base/host_device.h"
#include "render/base/vec.h"

namespace gladstone {

/// What became of a ray. A ray that dies is data: it is counted and reported, never thrown.
enum class RayStatus : int {
  alive,                      ///< reached the sensor's plane, inside the sensor's area
  missed_sensor,              ///< reached the sensor's plane outside its area: counts for truth, not for the image
  vignetted,                  ///< stopped by the aperture
  total_internal_reflection,  ///< could not leave a denser medium
  lost_in_medium,             ///< turned back or was trapped inside the medium
  missed_lens,                ///< runs parallel to or away from the lens
};
inline constexpr int ray_status_count = 6;

/// The word that files and reports use for a status.
constexpr char const* to_string(RayStatus status) {
  constexpr char const* words[ray_status_count] = {
      "alive", "missed_sensor", "vignetted", "total_internal_reflection", "lost_in_medium", "missed_lens"};
  return words[static_cast<int>(status)];
}

/// A straight ray in the world frame.
template <class T>
struct Ray {
  Vec3<T> position;   ///< [m]
  Vec3<T> direction;  ///< unit length
};

}  // namespace gladstone
