#pragma once

#include "render/optics/asphere.h"
#include "render/optics/quadric.h"

namespace gladstone::inline optics {

/// Even asphere: conic of revolution plus a polynomial in r^2, z = conic + a[0] r^2 + a[1] r^4 + ... + a[7] r^16 (ISO
/// 10110-12).
template <class T>
struct EvenAsphere {
  static constexpr int terms = 8;
  Quadric<T> conic;
  T a[terms]{};  ///< coefficients of r^2, r^4, ... [m^-1, m^-3, ...]

  GLADSTONE_HD T sag(T const& x, T const& y) const {
    T const r2 = x * x + y * y;
    return conic.sag(x, y) + r2 * polynomial(r2);
  }

  GLADSTONE_HD bool intersect(Ray<T> const& ray, T& way) const { return intersect_asphere(*this, ray, way); }

  GLADSTONE_HD Vec3<T> normal(Vec3<T> const& p) const { return normalized(gradient(p)); }

  /// Returns the gradient of z - sag(x, y) at a point of the surface.
  GLADSTONE_HD Vec3<T> gradient(Vec3<T> const& p) const {
    using std::sqrt;
    T const r2 = p.x * p.x + p.y * p.y;
    T slope = T(terms) * a[terms - 1];  // d(polynomial part)/d(r^2)
    for (int i = terms - 2; i >= 0; --i) slope = T(i + 1) * a[i] + r2 * slope;
    T const c = conic.curvature;
    slope = T(2) * slope + c / sqrt(T(1) - (T(1) + conic.conic) * c * c * r2);
    return {-slope * p.x, -slope * p.y, T(1)};
  }

  GLADSTONE_HD T vertex_curvature() const { return conic.curvature + T(2) * a[0]; }

  template <class U>
  EvenAsphere<U> in_scalar() const {
    EvenAsphere<U> same{conic.template in_scalar<U>(), {}};
    for (int i = 0; i < terms; ++i) same.a[i] = U(a[i]);
    return same;
  }

 private:
  GLADSTONE_HD T polynomial(T const& r2) const {
    T sum = a[terms - 1];
    for (int i = terms - 2; i >= 0; --i) sum = a[i] + r2 * sum;
    return sum;
  }
};

}  // namespace gladstone::inline optics
