#pragma once

#include "render/optics/quadric.h"

namespace gladstone {

/// A conic of revolution and a polynomial in r^2: z = conic + a[0] r^2 + a[1] r^4 + ... + a[7] r^16 (ISO 10110-12).
template <class T>
struct EvenAsphere {
  static constexpr int terms = 8;
  Quadric<T> conic;
  T a[terms]{};  ///< of r^2, r^4, ... [m^-1, m^-3, ...]

  GLADSTONE_HD T sag(T const& x, T const& y) const {
    T const r2 = x * x + y * y;
    return conic.sag(x, y) + r2 * polynomial(r2);
  }

  /// As Quadric::intersect, by Newton's method from the conic, or the vertex plane where the conic is missed.
  GLADSTONE_HD bool intersect(Ray<T> const& ray, T& way) const {
    if (!conic.intersect(ray, way)) {
      if (ray.direction.z == T(0)) return false;
      way = -ray.position.z / ray.direction.z;
    }
    // steps shrink quadratically until rounding holds them up; one step after that makes derivatives exact as well
    T last = T(1);
    for (int step = 0; step < most_steps; ++step) {
      Vec3<T> const p = ray.position + way * ray.direction;
      T const height = p.z - sag(p.x, p.y);
      Vec3<T> const up = gradient(p);
      T const change = height / dot(up, ray.direction);
      T const size = change < T(0) ? -change : change;
      if (!(size < last)) return size < T(tolerance);  // NaN too ends here, off the conic's reach
      way = way - change;
      last = size;
      if (size == T(0)) return true;
    }
    return last < T(tolerance);
  }

  GLADSTONE_HD Vec3<T> normal(Vec3<T> const& p) const { return normalized(gradient(p)); }

  template <class U>
  EvenAsphere<U> in_scalar() const {
    EvenAsphere<U> same{conic.template in_scalar<U>(), {}};
    for (int i = 0; i < terms; ++i) same.a[i] = U(a[i]);
    return same;
  }

 private:
  static constexpr int most_steps = 30;
  static constexpr double tolerance = 1e-9;  // [m]; met or not by many orders

  GLADSTONE_HD T polynomial(T const& r2) const {
    T sum = a[terms - 1];
    for (int i = terms - 2; i >= 0; --i) sum = a[i] + r2 * sum;
    return sum;
  }
  /// Gradient of z - sag(x, y).
  GLADSTONE_HD Vec3<T> gradient(Vec3<T> const& p) const {
    using std::sqrt;
    T const r2 = p.x * p.x + p.y * p.y;
    T slope = T(terms) * a[terms - 1];  // d(polynomial part)/d(r^2)
    for (int i = terms - 2; i >= 0; --i) slope = T(i + 1) * a[i] + r2 * slope;
    T const c = conic.curvature;
    slope = T(2) * slope + c / sqrt(T(1) - (T(1) + conic.conic) * c * c * r2);
    return {-slope * p.x, -slope * p.y, T(1)};
  }
};

}  // namespace gladstone
