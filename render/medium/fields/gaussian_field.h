#pragma once

#include <algorithm>
#include <cmath>

#include "render/base/units.h"
#include "render/medium/fields/slab.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline medium {

/// Parameters common to plume and blob: rho = rho_0 + A exp(-r^2 / a^2), r the distance from an axis or a point.
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

  T finest() const { return radius / 2; }
  /// Upper bound of |grad n| [1/m]: the largest slope of A exp(-r^2/a^2) is sqrt(2/e) A / a.
  T steepest() const { return this->gladstone_dale * std::abs(amplitude) * 0.85776388496 / radius; }
  /// Returns the largest gradient, within a distance `reach` [m] from the axis, of the density averaged over the slab
  /// -h < z < h [kg/m^4]. The gradient
  ///   2 |A| r / a^2 exp(-r^2 / a^2) sqrt(pi) a erf(h / a) / (2 h)
  /// is largest at r = a / sqrt(2), or at r = reach if that is smaller. For h >> a it is sqrt(2 pi / e) |A| / (2 h).
  T steepest_mean_density_within(T reach) const {
    T const r = std::min(reach, radius / std::sqrt(T(2))), h = this->half_thickness;
    T const slope = T(2) * std::abs(amplitude) * r / (radius * radius) * std::exp(-r * r / (radius * radius));
    return slope * std::sqrt(T(pi)) * radius * std::erf(h / radius) / (T(2) * h);
  }
  DensityRange densities(Vec2d) const {
    return {this->ambient_density + std::min(amplitude, 0.0), this->ambient_density + std::max(amplitude, 0.0)};
  }
  /// Radius of the decay along Z as exp(-z^2 / a^2), to compare with the thickness of the slab [m].
  T radius_along_z() const { return radius; }
};

}  // namespace gladstone::inline medium
