#pragma once

#include "render/base/host_device.h"
#include "render/base/ray.h"

namespace gladstone::inline scene {

/// The two images of a pair: reference and measurement image (PIV: frames A and B).
enum class Frame : int { reference = 0, flow = 1 };
inline constexpr int frame_count = 2;

/// End of a ray on the sensor.
template <class T>
struct RayHit {
  RayStatus status = RayStatus::alive;
  Vec2<T> pixel{};    ///< position on the sensor's plane [px]; valid if reaches_sensor_plane(status)
  T weight{};         ///< weight at the sensor: weight of the emitted ray times transmission; 0: blocked
  Vec2<T> at_lens{};  ///< intersection with the aim plane, in its frame [m]
};

/// Returns true for rays that contribute to the truth: those that pass the stop and meet the sensor's plane, inside or
/// outside the sensor's area.
GLADSTONE_HD constexpr bool reaches_sensor_plane(RayStatus status) {
  return status == RayStatus::alive || status == RayStatus::missed_sensor;
}

}  // namespace gladstone::inline scene
