#pragma once

#include <optional>
#include <type_traits>
#include <utility>

#include "render/optics/camera_element.h"

namespace gladstone {

/// Carries a ray backwards through an element, from the side that light leaves on: the indices on either side change
/// places. Edges stop no such ray.
/// @return false where it misses the element or is totally reflected, and for elements without a way back
template <class Element>
bool trace_back(Element const& element, Ray<double>& ray) {
  if constexpr (requires { element.n_before + element.n_after; }) {
    Element reversed = element;
    std::swap(reversed.n_before, reversed.n_after);
    RayAccount<double> account;
    RayStatus const status = reversed.interact(ray, account);
    return status == RayStatus::alive || status == RayStatus::vignetted;
  } else {
    return std::is_same_v<Element, PosedStop<double>>;
  }
}

/// Whether an element is a mirror, which turns light along -z.
template <class Element>
bool is_mirror(Element const& element) {
  if constexpr (requires { element.action; }) return element.action == SurfaceAction::reflect;
  return false;
}

/// The ray that runs backwards from the stop's centre through elements [0, stop), as it leaves them towards the source.
/// @param elements each with a visit() @param slope dx/dz, dy/dz at the stop, in its frame
/// @return nothing where no light comes from there
template <class Elements>
std::optional<Ray<double>> trace_back_from_stop(Elements const& elements, int stop, Vec2d slope) {
  auto const element = [&](int i) -> auto const& { return elements[static_cast<std::size_t>(i)]; };
  double sense = -1;  // against the light, which every mirror turns
  for (int i = 0; i < stop; ++i) {
    if (element(i).visit([](auto const& held) { return is_mirror(held); })) sense = -sense;
  }
  Pose<double> const pose = element(stop).visit([](auto const& held) { return held.pose; });
  Ray<double> ray = pose.outwards(Ray<double>{{}, sense * normalized(Vec3d{slope.x, slope.y, 1})});
  for (int i = stop - 1; i >= 0; --i) {
    if (!element(i).visit([&](auto const& held) { return trace_back(held, ray); })) return std::nullopt;
  }
  return ray;
}

}  // namespace gladstone
