#pragma once

#include "render/optics/asphere.h"
#include "render/optics/quadric.h"

namespace gladstone {

/// A conic of revolution and a polynomial in the distance r from the axis: z = conic + sum of a[i] (r / scale)^(i + 1),
/// or of (r / scale)^(2 i + 2). Design programs call it an extended (odd) asphere. Where the term of r itself is not
/// zero, the surface has a cone's tip on the axis; its normal there is taken along the axis.
template <class T>
struct RadialAsphere {
  static constexpr int terms = 20;
  Quadric<T> conic;
  T scale = T(1);           ///< radius that normalises r [m]
  bool even_powers = true;  ///< r^2, r^4, ...; false: r, r^2, r^3, ...
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

  /// Gradient of z - sag(x, y).
  GLADSTONE_HD Vec3<T> gradient(Vec3<T> const& p) const {
    using std::sqrt;
    T const r2 = p.x * p.x + p.y * p.y;
    T const c = conic.curvature;
    T const slope = slope_over_radius(r2) + c / sqrt(T(1) - (T(1) + conic.conic) * c * c * r2);
    return {-slope * p.x, -slope * p.y, T(1)};
  }

  /// Curvature that the polynomial adds to the conic's at the vertex [1/m].
  GLADSTONE_HD T vertex_curvature() const { return T(2) * a[even_powers ? 0 : 1] / (scale * scale); }

  template <class U>
  RadialAsphere<U> in_scalar() const {
    RadialAsphere<U> same{conic.template in_scalar<U>(), U(scale), even_powers, {}};
    for (int i = 0; i < terms; ++i) same.a[i] = U(a[i]);
    return same;
  }

 private:
  /// What the polynomial is one of: (r / scale)^2 or r / scale. On the axis it has no derivative by r^2, where a root's
  /// would be infinite.
  GLADSTONE_HD T variable(T const& r2) const {
    using std::sqrt;
    if (even_powers) return r2 / (scale * scale);
    return r2 > T(0) ? sqrt(r2) / scale : T(0);
  }

  /// d(polynomial part)/dr / r [1/m].
  GLADSTONE_HD T slope_over_radius(T const& r2) const {
    if (!even_powers && !(r2 > T(0))) return vertex_curvature();
    T const u = variable(r2);
    T slope = T(terms) * a[terms - 1];  // by the variable
    for (int i = terms - 2; i >= 0; --i) slope = T(i + 1) * a[i] + u * slope;
    return even_powers ? T(2) * slope / (scale * scale) : slope / (u * scale * scale);
  }
};

}  // namespace gladstone
