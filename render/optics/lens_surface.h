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

namespace gladstone::inline optics {

/// Effect of a surface on a ray.
enum class SurfaceAction : int {
  pass,     ///< none: stop or reference plane
  refract,  ///< refraction by Snell's law
  reflect,  ///< reflection by a mirror
  focus,    ///< ideal thin lens, exact in slopes s: n' s' = n s - position / focal length
};

/// Quantities that accumulate along a ray.
template <class T>
struct RayAccount {
  T weight = T(1);   ///< fraction of the ray's light that remains [1]
  T optical_path{};  ///< optical path length [m]
};

/// Surface of a lens: shape, pose, and media on both sides. Accepts rays of any direction.
template <class T, class Shape>
struct ShapedSurface {
  Pose<T> pose;  ///< pose of the vertex, in the lens' frame
  Shape shape;
  T semi_diameter{};  ///< rays outside this radius are vignetted [m]
  T n_before = T(1);  ///< index on the side of incidence [1]
  T n_after = T(1);   ///< index on the other side [1]
  T absorption{};     ///< absorption coefficient of the medium ahead of the surface [1/m]
  SurfaceAction action = SurfaceAction::refract;
  bool fresnel = false;  ///< true: rays lose light by Fresnel reflection
  T obscured{};          ///< rays inside this radius are vignetted; 0: none [m]
  T power{};             ///< reciprocal of the focal length in air, for SurfaceAction::focus [1/m]
  SurfaceOutline<T> outline = {};

  /// Computes the intersection of a ray with the surface, as (x, y) in the vertex frame [m]. @return false if it misses
  GLADSTONE_HD bool meet(Ray<T> const& ray, Vec2<T>& place) const {
    Ray<T> const local = pose.inwards(ray);
    T way;
    if (!shape.intersect(local, way)) return false;
    place = {local.position.x + way * local.direction.x, local.position.y + way * local.direction.y};
    return true;
  }

  /// Moves a ray to the surface and refracts or reflects it. Optical paths are undefined behind an ideal thin lens.
  /// @return alive; vignetted (the ray is refracted all the same); total_internal_reflection; or missed_lens if the ray
  /// does not intersect the surface
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

  /// Returns true if the surface is a circular stop about its axis without any other effect.
  GLADSTONE_HD bool is_plain_stop() const {
    return action == SurfaceAction::pass && obscured == T(0) && outline.kind == SurfaceOutline<T>::Kind::none;
  }

 private:
  /// Deflects a ray like an ideal thin lens, for both directions along the axis.
  GLADSTONE_HD void focus(Ray<T>& local) const {
    Vec3<T> const& d = local.direction;
    T const sense = d.z < T(0) ? T(-1) : T(1);
    T const along = sense * d.z;
    T const sx = (n_before * d.x / along - power * local.position.x) / n_after;
    T const sy = (n_before * d.y / along - power * local.position.y) / n_after;
    local.direction = normalized(Vec3<T>{sx, sy, sense});
  }
};

/// Closed set of the shapes of a lens surface. To add one, write its struct, add its name to this list, and build it in
/// make_shape() (lens.cpp).
template <class T>
using LensShape = OneOf<Quadric<T>, EvenAsphere<T>, RadialAsphere<T>, TiltedPlane<T>>;

template <class T, class Shapes>
struct ShapedSurfaces;
template <class T, class... Shapes>
struct ShapedSurfaces<T, OneOf<Shapes...>> {
  using Type = OneOf<ShapedSurface<T, Shapes>...>;
};

/// Surface of a lens with any of the shapes.
template <class T>
using LensSurface = typename ShapedSurfaces<T, LensShape<T>>::Type;

}  // namespace gladstone::inline optics
