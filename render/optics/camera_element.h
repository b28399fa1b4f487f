#pragma once

#include <type_traits>

#include "render/base/in_scalar.h"
#include "render/base/one_of.h"
#include "render/base/pose.h"
#include "render/optics/aperture_stop.h"
#include "render/optics/lens_surface.h"
#include "render/optics/lenslet_array.h"

namespace gladstone {

/// A circular stop anywhere, facing any way: lets light of its own z through, forwards or back.
template <class T>
struct PosedStop {
  Pose<T> pose;
  T radius{};  ///< [m]
  T edge{};    ///< width of the zone about the rim that quadrature smooths, see ApertureStop; 0: sharp

  /// Where a ray meets the stop's plane, in its own frame [m]. @return false where it runs along it
  GLADSTONE_HD bool meet(Ray<T> const& ray, Vec2<T>& place) const { return pose.meet(ray, place); }

  /// Weighs a ray, which stays where it is: what limits light needs not stand in the order of the elements.
  /// @return vignetted outside the radius, whatever the rim leaves of it
  GLADSTONE_HD RayStatus interact(Ray<T>& ray, RayAccount<T>& account) const {
    Vec2<T> p;
    if (!meet(ray, p)) return RayStatus::missed_lens;
    account.weight = account.weight * ApertureStop<T>{T(0), radius, edge}.transmission(p.x, p.y);
    return p.x * p.x + p.y * p.y > radius * radius ? RayStatus::vignetted : RayStatus::alive;
  }

  template <class U>
  PosedStop<U> in_scalar() const {
    return {gladstone::in_scalar<U>(pose), U(radius), U(edge)};
  }
};

/// An ideal thin lens anywhere, facing any way: ThinLens in its own frame. Light runs along its z.
template <class T>
struct PosedThinLens {
  Pose<T> pose;
  T focal_length{};  ///< [m]

  GLADSTONE_HD bool meet(Ray<T> const& ray, Vec2<T>& place) const { return pose.meet(ray, place); }

  /// @return missed_lens for rays that do not run towards it; optical paths are undefined behind it
  GLADSTONE_HD RayStatus interact(Ray<T>& ray, RayAccount<T>&) const {
    Ray<T> const local = pose.inwards(ray);
    if (!(local.direction.z > T(0))) return RayStatus::missed_lens;
    T const sx = local.direction.x / local.direction.z, sy = local.direction.y / local.direction.z;
    T const x = local.position.x - sx * local.position.z, y = local.position.y - sy * local.position.z;
    Vec3<T> const turned{sx - x / focal_length, sy - y / focal_length, T(1)};
    ray = pose.outwards(Ray<T>{{x, y, T(0)}, normalized(turned)});
    return RayStatus::alive;
  }

  template <class U>
  PosedThinLens<U> in_scalar() const {
    return {gladstone::in_scalar<U>(pose), U(focal_length)};
  }
};

/// Every element that a ray can meet between its source and the sensor. An element owns its pose in the world, takes
/// rays of any direction, and has `RayStatus interact(Ray<T>&, RayAccount<T>&) const`. Adding one: its struct, and its
/// name here.
template <class T>
using CameraElement =
    OneOf<PosedStop<T>, PosedThinLens<T>, ShapedSurface<T, Quadric<T>>, ShapedSurface<T, EvenAsphere<T>>,
          LensletArray<T>, ShapedSurface<T, RadialAsphere<T>>, ShapedSurface<T, TiltedPlane<T>>>;

/// The same element in another scalar: in ceres::Jets, rays through it carry their derivatives by its place and form.
template <class U, class T>
CameraElement<U> in_scalar(CameraElement<T> const& element) {
  return element.visit([](auto const& held) -> CameraElement<U> { return held.template in_scalar<U>(); });
}

/// Takes a ray to an element of a known kind and through it; its weight is 0 where it ends there. The smoothed rim of a
/// stop lets a share of vignetted rays pass: theirs is not 0.
template <class T, class Held>
GLADSTONE_HD RayStatus pass(Held const& held, Ray<T>& ray, RayAccount<T>& account) {
  RayStatus const status = held.interact(ray, account);
  constexpr bool weighs = std::is_same_v<Held, PosedStop<T>>;
  if (!weighs && status != RayStatus::alive) account.weight = T(0);
  return status;
}
template <class T>
GLADSTONE_HD RayStatus pass_element(CameraElement<T> const& element, Ray<T>& ray, RayAccount<T>& account) {
  return element.visit([&](auto const& held) { return pass(held, ray, account); });
}

}  // namespace gladstone
