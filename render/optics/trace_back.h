#pragma once

#include <optional>
#include <type_traits>
#include <utility>

#include "render/optics/camera_element.h"

namespace gladstone::inline optics {

/// Traces a ray backwards through an element, with the indices on both sides exchanged. Vignetting is ignored.
/// @return false if the ray misses the element or is totally reflected, and for elements that cannot be traced
/// backwards
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

/// Returns true if an element is a mirror, which reverses the direction of light along z.
template <class Element>
bool is_mirror(Element const& element) {
  if constexpr (requires { element.action; }) return element.action == SurfaceAction::reflect;
  return false;
}

/// Traces a ray backwards from the centre of the stop through elements [0, stop) and returns it where it leaves the
/// first element towards the source.
/// @param elements  elements with a visit() method
/// @param slope     dx/dz, dy/dz at the stop, in its frame
/// @return nullopt if the ray is lost
template <class Elements>
std::optional<Ray<double>> trace_back_from_stop(Elements const& elements, int stop, Vec2d slope) {
  auto const element = [&](int i) -> auto const& { return elements[static_cast<std::size_t>(i)]; };
  double sense = -1;  // against the light, whose direction every mirror reverses
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

}  // namespace gladstone::inline optics
