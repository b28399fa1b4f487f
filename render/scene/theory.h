#pragma once

#include "render/base/host_device.h"
#include "render/medium/trace_medium.h"

namespace gladstone {

/// Integrals along a straight ray through the medium, over z.
template <class T>
struct GradientIntegral {
  T refractivity{};   ///< integral of (n - 1) dz [m]
  T depth{};          ///< integral of dz inside the medium [m]
  Vec2<T> plain{};    ///< integral of (dn/dx, dn/dy) dz [1]
  Vec2<T> levered{};  ///< the same with each slice's own distance from the ray's start plane [m]
};

/// Calls visit(sample, s, ds) at the points of a quadrature along a straight ray through the medium: Gauss-Legendre
/// panels of three points no longer than `step`; s is the way from the ray's start [m]. Outside the medium there is
/// nothing.
template <class T, class Medium, class Visit>
GLADSTONE_HD void along_field(Medium const& medium, Ray<T> const& start, T step, Visit&& visit) {
  using std::ceil;
  constexpr double root = 0.77459666924148337704;  // sqrt(3/5)
  detail::Chord<T> const chord = detail::chord_in(medium.bounds(), start.position, start.direction);
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

/// Integrates grad n over z along an undeflected ray, as along_field().
/// @param start the ray, from the target's plane; outside the medium there is no gradient
template <class T, class Medium>
GLADSTONE_HD GradientIntegral<T> integrate_gradient(Medium const& medium, Ray<T> const& start, T step) {
  GradientIntegral<T> sum;
  along_field(medium, start, step, [&](IndexSample<T> const& sample, T s, T ds) {
    T const dz = ds * start.direction.z;
    Vec2<T> const slice{sample.gradient.x * dz, sample.gradient.y * dz};
    sum.refractivity += sample.refractivity * dz;
    sum.depth += dz;
    sum.plain += slice;
    sum.levered += slice * (s * start.direction.z);
  });
  return sum;
}

/// Displacement on the sensor that a deflection integral stands for [px]: dots appear displaced against grad n, and
/// rows run downwards. Rajendran et al. eq. 9: M Z_D / (n_0 p) times the integral.
/// @param magnification M; lever Z_D [m] with `plain` integrals, 1 with `levered` ones; n0 ambient index; pitch [m]
template <class T>
GLADSTONE_HD Vec2<T> theory_displacement(Vec2<T> integral, T lever, T magnification, T n0, T pitch) {
  T const scale = magnification * lever / (n0 * pitch);
  return {-scale * integral.x, scale * integral.y};
}

}  // namespace gladstone
