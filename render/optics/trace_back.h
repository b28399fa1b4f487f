#pragma once

#include <optional>
#include <type_traits>
#include <utility>

#include "render/optics/camera_element.h"

namespace gladstone {

/// Carries the line of a ray backwards through an element, from the side that light leaves on. The indices on either
/// side change places; the sense of the direction does not matter, since Snell's law and the law of reflection hold for
/// lines. Edges stop no line.
/// @return false where the line misses the element or is totally reflected, and for elements without a way back
template <class Element>
bool trace_back(Element const& element, Ray<double>& line) {
  if constexpr (requires { element.n_before + element.n_after; }) {
    Element reversed = element;
    std::swap(reversed.n_before, reversed.n_after);
    RayAccount<double> account;
    RayStatus const status = reversed.interact(line, account);
    return status == RayStatus::alive || status == RayStatus::vignetted;
  } else {
    return std::is_same_v<Element, PosedStop<double>>;
  }
}

/// The line in front of elements [0, stop) whose ray meets the stop's centre at a slope dx/dz, dy/dz in the stop's own
/// frame. @param elements each with a visit() @return nothing where no light comes from there
template <class Elements>
std::optional<Ray<double>> trace_back_from_stop(Elements const& elements, int stop, Vec2d slope) {
  Pose<double> const pose = elements[static_cast<std::size_t>(stop)].visit([](auto const& held) { return held.pose; });
  Ray<double> line = pose.outwards(Ray<double>{{}, normalized(Vec3d{slope.x, slope.y, 1})});
  for (int i = stop - 1; i >= 0; --i) {
    if (!elements[static_cast<std::size_t>(i)].visit([&](auto const& held) { return trace_back(held, line); }))
      return std::nullopt;
  }
  return line;
}

}  // namespace gladstone
