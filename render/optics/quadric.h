#pragma once

#include <cmath>

#include "render/base/host_device.h"
#include "render/base/ray.h"

namespace gladstone::inline optics {

/// Plane, sphere, conic of revolution or cylinder with its vertex at the origin, as one equation: z = (c/2) (x^2 + e
/// y^2 + (1 + k) z^2). The sheet (branch) of this surface through the vertex is z = c r^2 / (1 + sqrt(1 - (1 + k) c^2
/// r^2)) (Welford, Aberrations of Optical Systems, 1986, section 4.4).
template <class T>
struct Quadric {
  T curvature{};     ///< c, reciprocal of the radius; positive if the centre is on the +z side [1/m]
  T conic{};         ///< k; 0: sphere, -1: paraboloid [1]
  T along_y = T(1);  ///< e; 1: surface of revolution, 0: cylinder curved along x only

  /// Returns the height above the vertex plane [m]; NaN beyond the extent of the sheet.
  GLADSTONE_HD T sag(T const& x, T const& y) const {
    using std::sqrt;
    T const r2 = x * x + along_y * y * y;
    return curvature * r2 / (T(1) + sqrt(T(1) - (T(1) + conic) * curvature * curvature * r2));
  }

  /// Intersects a ray (unit direction, in this frame) with the sheet through the vertex.
  /// @param way  distance along the ray, negative backwards [m]
  /// @return false if the ray misses the sheet
  GLADSTONE_HD bool intersect(Ray<T> const& ray, T& way) const {
    using std::sqrt;
    // start at the point of the ray closest to the vertex: for distant origins the squares below lose digits
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
    // prefer the root that tends to the plane's intersection for zero curvature; steep rays may hit the sheet at the
    // other
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

  /// Returns the curvature at the vertex, along x for a cylinder [1/m].
  GLADSTONE_HD T vertex_curvature() const { return curvature; }

  /// Returns the unit normal at a point of the surface, in +z direction at the vertex.
  GLADSTONE_HD Vec3<T> normal(Vec3<T> const& p) const {
    Vec3<T> const along{-curvature * p.x, -curvature * along_y * p.y, T(1) - (T(1) + conic) * curvature * p.z};
    // for planes and spheres it has unit length without normalisation
    return conic == T(0) && along_y == T(1) ? along : normalized(along);
  }

  template <class U>
  Quadric<U> in_scalar() const {
    return {U(curvature), U(conic), U(along_y)};
  }

 private:
  /// The sheet through the vertex is the part of the surface with dF/dz >= 0.
  GLADSTONE_HD bool on_sheet(T const& z) const { return T(1) - (T(1) + conic) * curvature * z >= T(0); }
};

}  // namespace gladstone::inline optics
