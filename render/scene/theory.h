#pragma once

#include "render/base/host_device.h"
#include "render/medium/trace_medium.h"

namespace gladstone::inline scene {

/// Integrals over z along a straight ray through the medium.
template <class T>
struct GradientIntegral {
  T refractivity{};          ///< integral of (n - 1) dz [m]
  T depth{};                 ///< integral of dz inside the medium [m]
  Vec2<T> plain{};           ///< integral of (dn/dx, dn/dy) dz [1]
  Vec2<T> lever_weighted{};  ///< integral of (dn/dx, dn/dy) z' dz, z' measured from the plane of the ray's start [m]
};

/// Calls visit(sample, s, ds) at the nodes of a composite Gauss-Legendre quadrature (three nodes per panel) along a
/// straight ray. Only the part inside the medium is sampled.
/// @param step  maximum length of a panel [m]
/// @param visit  receives the index sample, the distance s from the ray's start [m] and the node's weight ds [m]
template <class T, class Medium, class Visit>
GLADSTONE_HD void along_field(Medium const& medium, Ray<T> const& start, T step, Visit&& visit) {
  using std::ceil;
  constexpr double root = 0.77459666924148337704;  // sqrt(3/5)
  Chord<T> const chord = chord_in(medium.bounds(), start.position, start.direction);
  T const way = chord.leave - chord.enter;
  if (!(way > T(0))) return;
  int const panels = static_cast<int>(ceil(way / step * (T(1) - T(1e-6)))) + (way < step * T(1e-6) ? 1 : 0);
  T const half = T(0.5) * way / T(panels);
  for (int panel = 0; panel < panels; ++panel) {
    T const middle = chord.enter + half * T(2 * panel + 1);
    for (int point = -1; point <= 1; ++point) {
      T const s = middle + half * T(point) * T(root);
      visit(medium.sample(start.position + start.direction * s), s, half * (point == 0 ? T(8.0 / 9.0) : T(5.0 / 9.0)));
    }
  }
}

/// Integrates the refractivity and the gradient of n over z along an undeflected ray by along_field().
/// @param start  straight ray, starting in the target's plane
template <class T, class Medium>
GLADSTONE_HD GradientIntegral<T> integrate_gradient(Medium const& medium, Ray<T> const& start, T step) {
  GradientIntegral<T> sum;
  along_field(medium, start, step, [&](IndexSample<T> const& sample, T s, T ds) {
    T const dz = ds * start.direction.z;
    Vec2<T> const slice{sample.gradient.x * dz, sample.gradient.y * dz};
    sum.refractivity += sample.refractivity * dz;
    sum.depth += dz;
    sum.plain += slice;
    sum.lever_weighted += slice * (s * start.direction.z);
  });
  return sum;
}

/// Computes the displacement on the sensor from a deflection integral by small-angle theory [px]: M Z_D / (n_0 p) times
/// the integral (Rajendran et al. 2019, Eq. 9). Dots appear displaced against grad n, and image rows run downwards.
/// @param integral  member `plain` or `lever_weighted` of GradientIntegral
/// @param lever  Z_D [m] with `plain`, 1 with `lever_weighted`
/// @param magnification  M [1]
/// @param n0  ambient index [1]
/// @param pitch  pixel pitch p [m]
template <class T>
GLADSTONE_HD Vec2<T> theory_displacement(Vec2<T> integral, T lever, T magnification, T n0, T pitch) {
  T const scale = magnification * lever / (n0 * pitch);
  return {-scale * integral.x, scale * integral.y};
}

}  // namespace gladstone::inline scene
