#pragma once

#include <algorithm>
#include <cmath>

#include "render/base/setup_table.h"
#include "render/base/units.h"
#include "render/medium/fields/slab.h"

namespace gladstone {

/// What plume and blob share: rho = rho_0 + A exp(-r^2 / a^2), r the distance from an axis or a point.
template <class T>
struct GaussianField : Slab<T> {
  static constexpr char const* density_key = "amplitude_kg_m3";
  static constexpr char const* length_key = "radius_mm";

  T amplitude{};  ///< A [kg/m^3]
  T radius{};     ///< a [m]

  static GaussianField read_keys(SetupTable& table) {
    double const amplitude = table.required_number("amplitude_kg_m3");
    return {{}, amplitude, table.required_number("radius_mm", Range::positive()) * unit::millimetre};
  }
  template <class U>
  GaussianField<U> keys_in_scalar() const {
    return {this->template slab_in_scalar<U>(), U(amplitude), U(radius)};
  }

  T finest() const { return radius / 2; }
  /// The largest slope of A exp(-r^2/a^2) is sqrt(2/e) A / a.
  T steepest() const { return this->gladstone_dale * std::abs(amplitude) * 0.85776388496 / radius; }
  /// F29, at r = a / sqrt(2).
  T steepest_mean_density() const {
    return std::sqrt(2 * pi / std::exp(1.0)) * std::abs(amplitude) / (2 * this->half_thickness);
  }
  DensityRange densities(Vec2d) const {
    return {this->ambient_density + std::min(amplitude, 0.0), this->ambient_density + std::max(amplitude, 0.0)};
  }
  /// It fades along Z as exp(-z^2 / a^2), so that a slab can be too thin for it [m].
  T radius_along_z() const { return radius; }
};

}  // namespace gladstone
