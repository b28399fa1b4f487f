#pragma once

#include <cmath>

#include "render/base/units.h"
#include "render/medium/fields/slab.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline medium {

/// Returns the density ratio across a normal shock in a perfect gas (Rankine-Hugoniot; NACA Report 1135, 1953, eq. 94).
/// @param mach  upstream Mach number >= 1
inline double shock_density_ratio(double mach, double gamma) {
  double const m2 = mach * mach;
  return (gamma + 1) * m2 / ((gamma - 1) * m2 + 2);
}

/// Normal shock of finite thickness in air. The density rises from rho_1 to rho_2 as a hyperbolic tangent of the
/// distance from a plane. The flow is in +x direction; the plane's normal is in the x-z plane, rotated by the tilt
/// about the Y axis. The thickness is based on the largest slope, (rho_2 - rho_1) / max(d rho / d x) (Prandtl's
/// definition).
template <class T>
struct NormalShock : Slab<T> {
  static constexpr char const* kind = "normal_shock";
  static constexpr char const* density_key = "upstream_density_kg_m3";
  static constexpr char const* length_key = "shock_thickness_mm";

  T upstream{};   ///< rho_1 [kg/m^3]
  T jump{};       ///< rho_2 - rho_1 [kg/m^3]
  T thickness{};  ///< [m]
  T position{};   ///< intersection of the plane with the X axis [m]
  T normal_x{1}, normal_z{0};
  T mach{1};  ///< upstream Mach number
  T tilt{};   ///< rotation of the normal about the Y axis [rad]

  /// Returns a shock with the given Mach number, rho_1 [kg/m^3], thickness [m], tilt [rad] and position [m].
  static NormalShock front(T mach, T upstream, T thickness, T tilt = 0, T position = 0) {
    T const ratio = shock_density_ratio(mach, constant::gamma_air);
    return {{}, upstream, upstream * (ratio - 1), thickness, position, std::cos(tilt), std::sin(tilt), mach, tilt};
  }
  static NormalShock read(SetupTable& table) {
    double const mach = table.required_number("mach", Range::at_least(1.0, 100.0));
    double const upstream = table.required_number("upstream_density_kg_m3", Range::positive());
    double const thickness = table.required_number("shock_thickness_mm", Range::positive()) * unit::millimetre;
    double const tilt = table.number("tilt_deg", 0.0, {-89.0, 89.0, false, false}) * unit::degree;
    return front(mach, upstream, thickness, tilt, table.number("position_mm", 0.0) * unit::millimetre);
  }

  GLADSTONE_HD IndexSample<T> sample(Vec3<T> p) const {
    using std::tanh;
    T const distance = (p.x - position) * normal_x + p.z * normal_z;
    T const profile = tanh(T(2) * distance / thickness);
    T const slope = jump / thickness * (T(1) - profile * profile);
    return this->from_density(upstream + T(0.5) * jump * (T(1) + profile), {slope * normal_x, T(0), slope * normal_z});
  }

  T finest() const { return thickness / 4; }
  T steepest() const { return this->gladstone_dale * jump / thickness; }
  DensityRange densities(Vec2d) const { return {upstream, upstream * shock_density_ratio(mach, constant::gamma_air)}; }
};

}  // namespace gladstone::inline medium
