#pragma once

#include "render/optics/asphere.h"
#include "render/optics/quadric.h"

namespace gladstone::inline optics {

/// Conic of revolution plus a polynomial in the distance r from the axis: z = conic + sum of a[i] (r / scale)^(i + 1),
/// or of a[i] (r / scale)^(2 i + 2). Design programs call it an extended (odd) asphere. If the term linear in r is not
/// zero, the surface has a conical tip on the axis, where its normal is defined as parallel to the axis.
template <class T>
struct RadialAsphere {
  static constexpr int terms = 20;
  Quadric<T> conic;
  T scale = T(1);           ///< normalisation radius of r [m]
  bool even_powers = true;  ///< true: powers r^2, r^4, ...; false: r, r^2, r^3, ...
  T a[terms]{};             ///< sag of each term at r = scale [m]

  GLADSTONE_HD T sag(T const& x, T const& y) const {
    T const r2 = x * x + y * y;
    T const u = variable(r2);
    T sum = a[terms - 1];
    for (int i = terms - 2; i >= 0; --i) sum = a[i] + u * sum;
    return conic.sag(x, y) + u * sum;
  }

  GLADSTONE_HD bool intersect(Ray<T> const& ray, T& way) const { return intersect_asphere(*this, ray, way); }

  GLADSTONE_HD Vec3<T> normal(Vec3<T> const& p) const { return normalized(gradient(p)); }

  /// Returns the gradient of z - sag(x, y) at a point of the surface.
  GLADSTONE_HD Vec3<T> gradient(Vec3<T> const& p) const {
    using std::sqrt;
    T const r2 = p.x * p.x + p.y * p.y;
    T const c = conic.curvature;
    T const slope = slope_over_radius(r2) + c / sqrt(T(1) - (T(1) + conic.conic) * c * c * r2);
    return {-slope * p.x, -slope * p.y, T(1)};
  }

  GLADSTONE_HD T vertex_curvature() const { return conic.curvature + polynomial_curvature(); }

  template <class U>
  RadialAsphere<U> in_scalar() const {
    RadialAsphere<U> same{conic.template in_scalar<U>(), U(scale), even_powers, {}};
    for (int i = 0; i < terms; ++i) same.a[i] = U(a[i]);
    return same;
  }

 private:
  /// Returns the curvature that the polynomial adds at the vertex [1/m].
  GLADSTONE_HD T polynomial_curvature() const { return T(2) * a[even_powers ? 0 : 1] / (scale * scale); }

  /// Returns the variable of the polynomial: (r / scale)^2 or r / scale. Returns a constant on the axis, where the
  /// derivative of the square root with respect to r^2 would be infinite.
  GLADSTONE_HD T variable(T const& r2) const {
    using std::sqrt;
    if (even_powers) return r2 / (scale * scale);
    return r2 > T(0) ? sqrt(r2) / scale : T(0);
  }

  /// Returns (1/r) d(polynomial)/dr [1/m].
  GLADSTONE_HD T slope_over_radius(T const& r2) const {
    if (!even_powers && !(r2 > T(0))) return polynomial_curvature();
    T const u = variable(r2);
    T slope = T(terms) * a[terms - 1];  // derivative with respect to u
    for (int i = terms - 2; i >= 0; --i) slope = T(i + 1) * a[i] + u * slope;
    return even_powers ? T(2) * slope / (scale * scale) : slope / (u * scale * scale);
  }
};

}  // namespace gladstone::inline optics
