#pragma once

#include <cmath>

#include "render/medium/fields/slab.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline medium {

/// Linear density field rho = rho_0 + g . x.
template <class T>
struct UniformGradient : Slab<T> {
  static constexpr char const* kind = "uniform_gradient";
  static constexpr char const* density_key = "gradient_kg_m4";
  static constexpr char const* length_key = "kind";
  /// The density is negative somewhere for any gradient, since the slab is infinite.
  static constexpr bool endless_range = true;

  Vec3<T> gradient{};  ///< g [kg/m^4]

  static UniformGradient read(SetupTable& table) {
    UniformGradient field;
    field.gradient = table.quantities("gradient_kg_m4", {10, 0, 0}, 1.0);
    return field;
  }

  GLADSTONE_HD IndexSample<T> sample(Vec3<T> p) const {
    return this->from_density(this->ambient_density + dot(gradient, p), gradient);
  }

  T finest() const { return 2 * this->half_thickness; }
  T steepest() const { return this->gladstone_dale * length(gradient); }
  T steepest_mean_density(Vec2d) const { return std::hypot(gradient.x, gradient.y); }
  DensityRange densities(Vec2d half_extent) const {
    double const change = std::abs(gradient.x) * half_extent.x + std::abs(gradient.y) * half_extent.y +
                          std::abs(gradient.z) * this->half_thickness;
    return {this->ambient_density - change, this->ambient_density + change};
  }
};

}  // namespace gladstone::inline medium
