#pragma once

#include <cmath>

#include "render/base/host_device.h"
#include "render/base/ray.h"

namespace gladstone {

/// Plane, sphere, conic of revolution or cylinder about its vertex at the origin, by one equation:
/// z = (c/2) (x^2 + e y^2 + (1 + k) z^2), whose sheet through the vertex is z = c r^2 / (1 + sqrt(1 - (1 + k) c^2 r^2))
/// (Welford, Aberrations of Optical Systems, 1986, section 4.4).
template <class T>
struct Quadric {
  T curvature{};     ///< c, one over the radius; positive where the centre lies towards +z [1/m]
  T conic{};         ///< k; 0: sphere, -1: paraboloid [1]
  T along_y = T(1);  ///< e; 1: of revolution, 0: a cylinder curved along x alone

  /// Height above the vertex plane [m]; NaN where the sheet does not reach.
  GLADSTONE_HD T sag(T const& x, T const& y) const {
    using std::sqrt;
    T const r2 = x * x + along_y * y * y;
    return curvature * r2 / (T(1) + sqrt(T(1) - (T(1) + conic) * curvature * curvature * r2));
  }

  /// Way along a ray (unit direction, in this frame) to the sheet through the vertex, forwards or back [m].
  /// @return false where the ray misses that sheet
  GLADSTONE_HD bool intersect(Ray<T> const& ray, T& way) const {
    using std::sqrt;
    // from where the ray passes nearest to the vertex: from afar the squares below would lose digits
    Vec3<T> const& d = ray.direction;
    T const approach = -dot(ray.position, d);
    Vec3<T> const p = ray.position + approach * d;
    T const k = T(1) + conic;
    T const a = curvature * (d.x * d.x + along_y * d.y * d.y + k * d.z * d.z);
    T const b = d.z - curvature * (p.x * d.x + along_y * p.y * d.y + k * p.z * d.z);
    T const c = curvature * (p.x * p.x + along_y * p.y * p.y + k * p.z * p.z) - T(2) * p.z;
    T const square = b * b - a * c;
    if (!(square > T(0))) return false;
    T const root = sqrt(square);
    // the root that goes over into the plane's as the curvature vanishes; steep rays may meet the sheet by the other
    T const near = d.z < T(0) ? b - root : b + root;
    if (near != T(0)) {
      T const there = c / near;
      way = approach + there;
      if (on_sheet(p.z + there * d.z)) return true;
    }
    if (a == T(0)) return false;
    way = approach + near / a;
    return on_sheet(p.z + near / a * d.z);
  }

  /// Unit normal at a point of the surface, towards +z at the vertex.
  GLADSTONE_HD Vec3<T> normal(Vec3<T> const& p) const {
    Vec3<T> const along{-curvature * p.x, -curvature * along_y * p.y, T(1) - (T(1) + conic) * curvature * p.z};
    // of a plane and a sphere it is the radius over itself, of unit length as it stands
    return conic == T(0) && along_y == T(1) ? along : normalized(along);
  }

  template <class U>
  Quadric<U> in_scalar() const {
    return {U(curvature), U(conic), U(along_y)};
  }

 private:
  /// The sheet through the vertex is where dF/dz stays positive.
  GLADSTONE_HD bool on_sheet(T const& z) const { return T(1) - (T(1) + conic) * curvature * z >= T(0); }
};

}  // namespace gladstone
