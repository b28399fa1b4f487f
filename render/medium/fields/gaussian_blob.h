#pragma once

#include <cmath>

#include "render/medium/fields/gaussian_field.h"

namespace gladstone::inline medium {

/// Spherical Gaussian density rho = rho_0 + A exp(-r^2 / a^2) about the origin.
template <class T>
struct GaussianBlob : GaussianField<T> {
  static constexpr char const* kind = "gaussian_blob";

  static GaussianBlob read(SetupTable& table) { return {GaussianField<T>::read_keys(table)}; }

  T steepest_mean_density(Vec2d half_extent) const { return this->steepest_mean_density_within(length(half_extent)); }

  GLADSTONE_HD IndexSample<T> sample(Vec3<T> p) const {
    using std::exp;
    T const a2 = this->radius * this->radius;
    T const excess = this->amplitude * exp(-dot(p, p) / a2);
    return this->from_density(this->ambient_density + excess, (T(-2) * excess / a2) * p);
  }
};

}  // namespace gladstone::inline medium
