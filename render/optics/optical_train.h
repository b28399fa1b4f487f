#pragma once

#include "render/optics/optical_element.h"

namespace gladstone {

/// The elements of a camera in the order light meets them, by value.
template <class T>
struct OpticalTrain {
  static constexpr int most_elements = 4;
  OpticalElement<T> elements[most_elements];
  int count = 0;

  GLADSTONE_HD void append(OpticalElement<T> const& element) { elements[count++] = element; }

  /// Carries a ray through all elements. It goes on while any of its light is left, also where a stop's smoothed edge
  /// lets part of a vignetted ray pass.
  /// @return alive, vignetted, or why it ended; missed_lens for rays that do not run towards the camera
  GLADSTONE_HD RayStatus carry(Ray<T>& ray, T& weight) const {
    RayStatus status = RayStatus::alive;
    for (int i = 0; i < count; ++i) {
      if (!(ray.direction.z > T(0))) {
        weight = T(0);
        return RayStatus::missed_lens;
      }
      RayStatus const here = elements[i].visit([&](auto const& element) { return element.interact(ray, weight); });
      if (here != RayStatus::alive) status = here;
      if (here != RayStatus::alive && here != RayStatus::vignetted) weight = T(0);
      if (weight == T(0)) return status;
    }
    return status;
  }
};

}  // namespace gladstone
