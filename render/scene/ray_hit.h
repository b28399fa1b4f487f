#pragma once

#include "render/base/host_device.h"
#include "render/base/ray.h"

namespace gladstone {

enum class Frame : int { reference = 0, flow = 1 };
inline constexpr int frame_count = 2;

/// Where a ray ended.
template <class T>
struct RayHit {
  RayStatus status = RayStatus::alive;
  Vec2<T> pixel{};    ///< on the sensor's plane [px]; defined where reaches_sensor_plane(status)
  T weight{};         ///< radiance cos^4 at the source [1]
  Vec2<T> at_lens{};  ///< where it met the lens plane [m]
};

/// True for rays that count for truth: past the stop and on the sensor's plane, inside its area or not.
GLADSTONE_HD constexpr bool reaches_sensor_plane(RayStatus status) {
  return status == RayStatus::alive || status == RayStatus::missed_sensor;
}

}  // namespace gladstone
