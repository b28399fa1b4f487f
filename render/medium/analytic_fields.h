#pragma once

#include <cmath>

#include "render/base/host_device.h"
#include "render/medium/index_sample.h"

namespace gladstone {

/// What every analytic field shares: a slab of given thickness about the mid-plane, endless in x and y.
template <class T>
struct Slab {
  T half_thickness{};   ///< [m]
  T gladstone_dale{};   ///< K [m^3/kg]
  T ambient_density{};  ///< rho_0 [kg/m^3]

  GLADSTONE_HD Bounds<T> bounds() const {
    T const u = T(unbounded);
    return {{-u, -u, -half_thickness}, {u, u, half_thickness}};
  }
  /// n - 1 = K rho (Gladstone & Dale 1863; Rajendran et al. eq. 1) and its gradient.
  GLADSTONE_HD IndexSample<T> from_density(T rho, Vec3<T> gradient) const {
    return {gladstone_dale * rho, gladstone_dale * gradient};
  }
};

/// No field: rays go straight.
template <class T>
struct NoMedium {
  GLADSTONE_HD Bounds<T> bounds() const { return {{}, {}}; }
  GLADSTONE_HD IndexSample<T> sample(Vec3<T>) const { return {T(0), {}}; }
};

/// rho = rho_0 + g . x
template <class T>
struct UniformGradient : Slab<T> {
  Vec3<T> gradient{};  ///< g [kg/m^4]

  GLADSTONE_HD IndexSample<T> sample(Vec3<T> p) const {
    return this->from_density(this->ambient_density + dot(gradient, p), gradient);
  }
};

/// rho = rho_0 + A sin(k . x + phase), k in the x-y plane
template <class T>
struct Sinusoid : Slab<T> {
  T amplitude{};         ///< A [kg/m^3]
  Vec2<T> wavevector{};  ///< 2 pi d / wavelength [1/m]
  T phase{};             ///< [rad]

  GLADSTONE_HD IndexSample<T> sample(Vec3<T> p) const {
    using std::cos;
    using std::sin;
    T const angle = wavevector.x * p.x + wavevector.y * p.y + phase;
    T const slope = amplitude * cos(angle);
    return this->from_density(this->ambient_density + amplitude * sin(angle),
                              {slope * wavevector.x, slope * wavevector.y, T(0)});
  }
};

/// rho = rho_0 + A exp(-(x^2 + z^2) / a^2): a column about the Y axis
template <class T>
struct GaussianPlume : Slab<T> {
  T amplitude{};  ///< A [kg/m^3]
  T radius{};     ///< a [m]

  GLADSTONE_HD IndexSample<T> sample(Vec3<T> p) const {
    using std::exp;
    T const excess = amplitude * exp(-(p.x * p.x + p.z * p.z) / (radius * radius));
    T const slope = T(-2) * excess / (radius * radius);
    return this->from_density(this->ambient_density + excess, {slope * p.x, T(0), slope * p.z});
  }
};

/// rho = rho_0 + A exp(-r^2 / a^2) about the origin
template <class T>
struct GaussianBlob : Slab<T> {
  T amplitude{};  ///< A [kg/m^3]
  T radius{};     ///< a [m]

  GLADSTONE_HD IndexSample<T> sample(Vec3<T> p) const {
    using std::exp;
    T const excess = amplitude * exp(-dot(p, p) / (radius * radius));
    return this->from_density(this->ambient_density + excess, (T(-2) * excess / (radius * radius)) * p);
  }
};

/// A normal shock of finite thickness: rho rises from rho_1 to rho_2 as a hyperbolic tangent of the distance from a
/// plane. The flow runs towards +x; the plane's normal lies in the x-z plane, turned by the tilt about the Y axis. The
/// thickness is the one of the largest slope, (rho_2 - rho_1) / max(d rho / d x) (Prandtl's definition).
template <class T>
struct NormalShock : Slab<T> {
  T upstream{};   ///< rho_1 [kg/m^3]
  T jump{};       ///< rho_2 - rho_1 [kg/m^3]
  T thickness{};  ///< [m]
  T position{};   ///< where the plane cuts the X axis [m]
  T normal_x{1}, normal_z{0};

  GLADSTONE_HD IndexSample<T> sample(Vec3<T> p) const {
    using std::tanh;
    T const distance = (p.x - position) * normal_x + p.z * normal_z;
    T const profile = tanh(T(2) * distance / thickness);
    T const slope = jump / thickness * (T(1) - profile * profile);
    return this->from_density(upstream + T(0.5) * jump * (T(1) + profile), {slope * normal_x, T(0), slope * normal_z});
  }
};

/// Density ratio over a normal shock in a perfect gas (Rankine-Hugoniot; NACA Report 1135, 1953, eq. 94).
/// @param mach upstream Mach number >= 1
inline double shock_density_ratio(double mach, double gamma) {
  double const m2 = mach * mach;
  return (gamma + 1) * m2 / ((gamma - 1) * m2 + 2);
}

}  // namespace gladstone
