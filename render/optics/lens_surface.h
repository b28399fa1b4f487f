#pragma once

#include <type_traits>

#include "render/base/in_scalar.h"
#include "render/base/one_of.h"
#include "render/base/pose.h"
#include "render/optics/even_asphere.h"
#include "render/optics/quadric.h"
#include "render/optics/radial_asphere.h"
#include "render/optics/refraction.h"
#include "render/optics/surface_outline.h"
#include "render/optics/tilted_plane.h"

namespace gladstone {

/// What a surface does to a ray that meets it.
enum class SurfaceAction : int {
  pass,     ///< lets it through: a stop, a plane of reference
  refract,  ///< Snell's law
  reflect,  ///< a mirror
  focus,    ///< an ideal thin lens, exact in slopes: n' s' = n s - place / focal length
};

/// What a ray carries through a train of surfaces besides its place and direction.
template <class T>
struct RayAccount {
  T weight = T(1);   ///< share of its light that is left [1]
  T optical_path{};  ///< [m]
};

/// One surface of a lens: a shape in its own pose, and what lies on either side. Takes rays of any direction.
template <class T, class Shape>
struct ShapedSurface {
  Pose<T> pose;  ///< of the vertex, in the lens' frame
  Shape shape;
  T semi_diameter{};  ///< rays that meet it further from its axis are vignetted [m]
  T n_before = T(1);  ///< index on the side that light comes from [1]
  T n_after = T(1);
  T absorption{};  ///< of the medium before it, in light per length [1/m]
  SurfaceAction action = SurfaceAction::refract;
  bool fresnel = false;  ///< whether a bare surface's reflection is taken off the light
  T obscured{};          ///< rays that meet it nearer to its axis are vignetted; 0: none [m]
  T power{};             ///< of SurfaceAction::focus: one over the focal length in air [1/m]
  SurfaceOutline<T> outline = {};

  /// Where a ray meets the surface, across the axis of its vertex [m]. @return false where it misses it
  GLADSTONE_HD bool meet(Ray<T> const& ray, Vec2<T>& place) const {
    Ray<T> const local = pose.inwards(ray);
    T way;
    if (!shape.intersect(local, way)) return false;
    place = {local.position.x + way * local.direction.x, local.position.y + way * local.direction.y};
    return true;
  }

  /// Moves a ray to the surface and turns it. @return alive, vignetted (the ray goes on all the same),
  /// total_internal_reflection, or missed_lens where it does not meet the surface. Behind an ideal thin lens optical
  /// paths are undefined
  GLADSTONE_HD RayStatus interact(Ray<T>& ray, RayAccount<T>& account) const {
    using std::exp;
    Ray<T> local = pose.inwards(ray);
    T way;
    if (!shape.intersect(local, way)) return RayStatus::missed_lens;
    local.position = local.position + way * local.direction;
    account.optical_path = account.optical_path + n_before * way;
    if (absorption > T(0)) account.weight = account.weight * exp(-absorption * way);
    RayStatus status = RayStatus::alive;
    T const r2 = local.position.x * local.position.x + local.position.y * local.position.y;
    if (r2 > semi_diameter * semi_diameter || r2 < obscured * obscured ||
        !outline.passes(local.position.x, local.position.y)) {
      status = RayStatus::vignetted;
    }
    if (action == SurfaceAction::focus) {
      focus(local);
    } else if (action != SurfaceAction::pass) {
      Vec3<T> const normal = shape.normal(local.position);
      if (action == SurfaceAction::reflect) {
        reflect(local.direction, normal);
      } else {
        T const before = dot(local.direction, normal);
        if (!refract(local.direction, normal, n_before, n_after)) return RayStatus::total_internal_reflection;
        if (fresnel) {
          T const after = dot(local.direction, normal);
          account.weight = account.weight * fresnel_transmittance(n_before, n_after, before < T(0) ? -before : before,
                                                                  after < T(0) ? -after : after);
        }
      }
    }
    ray = pose.outwards(local);
    return status;
  }

  template <class U>
  auto in_scalar() const {
    auto const same = shape.template in_scalar<U>();
    return ShapedSurface<U, std::remove_const_t<decltype(same)>>{gladstone::in_scalar<U>(pose),
                                                                 same,
                                                                 U(semi_diameter),
                                                                 U(n_before),
                                                                 U(n_after),
                                                                 U(absorption),
                                                                 action,
                                                                 fresnel,
                                                                 U(obscured),
                                                                 U(power),
                                                                 outline.template in_scalar<U>()};
  }

  /// Whether it does nothing but limit light by a disc about its axis.
  GLADSTONE_HD bool is_plain_stop() const {
    return action == SurfaceAction::pass && obscured == T(0) && outline.kind == SurfaceOutline<T>::Kind::none;
  }

 private:
  /// Turns a ray as an ideal thin lens does, whichever way it runs along the axis.
  GLADSTONE_HD void focus(Ray<T>& local) const {
    Vec3<T> const& d = local.direction;
    T const sense = d.z < T(0) ? T(-1) : T(1);
    T const along = sense * d.z;
    T const sx = (n_before * d.x / along - power * local.position.x) / n_after;
    T const sy = (n_before * d.y / along - power * local.position.y) / n_after;
    local.direction = normalized(Vec3<T>{sx, sy, sense});
  }
};

/// Every shape that a surface of a lens can have. Adding one: its struct, and its name here and among the camera's
/// elements (camera_element.h).
template <class T>
using LensSurface = OneOf<ShapedSurface<T, Quadric<T>>, ShapedSurface<T, EvenAsphere<T>>,
                          ShapedSurface<T, RadialAsphere<T>>, ShapedSurface<T, TiltedPlane<T>>>;

}  // namespace gladstone
