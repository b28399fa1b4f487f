#pragma once

#include "render/optics/optical_element.h"

namespace gladstone {

/// Elements of a camera by value, in the order of the light path.
template <class T>
struct OpticalTrain {
  static constexpr int most_elements = 4;
  OpticalElement<T> elements[most_elements];
  int count = 0;

  GLADSTONE_HD void append(OpticalElement<T> const& element) { elements[count++] = element; }

  /// Traces a ray through all elements, as long as its weight is not zero. This includes vignetted rays that are partly
  /// transmitted by the smoothed edge of a stop.
  /// @return alive, vignetted, or the reason for the ray's end; missed_lens if it does not travel in +z direction
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
