#pragma once

#include <cmath>

#include "render/medium/fields/gaussian_field.h"

namespace gladstone::inline medium {

/// Cylindrical Gaussian density about the Y axis: rho = rho_0 + A exp(-(x^2 + z^2) / a^2).
template <class T>
struct GaussianPlume : GaussianField<T> {
  static constexpr char const* kind = "gaussian_plume";

  static GaussianPlume read(SetupTable& table) { return {GaussianField<T>::read_keys(table)}; }

  T steepest_mean_density(Vec2d half_extent) const { return this->steepest_mean_density_within(half_extent.x); }

  GLADSTONE_HD IndexSample<T> sample(Vec3<T> p) const {
    using std::exp;
    T const a2 = this->radius * this->radius;
    T const excess = this->amplitude * exp(-(p.x * p.x + p.z * p.z) / a2);
    T const slope = T(-2) * excess / a2;
    return this->from_density(this->ambient_density + excess, {slope * p.x, T(0), slope * p.z});
  }
};

}  // namespace gladstone::inline medium
