#pragma once

#include <type_traits>

#include "render/base/in_scalar.h"
#include "render/base/one_of.h"
#include "render/base/pose.h"
#include "render/optics/aperture_stop.h"
#include "render/optics/element_kinds.h"
#include "render/optics/lens_surface.h"

namespace gladstone::inline optics {

/// Circular stop with any pose. Transmits rays along its z axis in both directions.
template <class T>
struct PosedStop {
  Pose<T> pose;
  T radius{};  ///< radius of the stop [m]
  T edge{};    ///< area of the smoothed zone about the edge relative to the stop's area, see ApertureStop [1]; 0: sharp

  /// Computes the intersection of a ray with the stop's plane, in its frame [m]. @return false if they are parallel
  GLADSTONE_HD bool meet(Ray<T> const& ray, Vec2<T>& place) const { return pose.meet(ray, place); }

  /// Multiplies the ray's weight by the stop's transmission. The ray itself is not moved, so that a stop need not be at
  /// its position in the sequence of elements.
  /// @return vignetted outside the radius, even if the smoothed rim transmits part of the light
  GLADSTONE_HD RayStatus interact(Ray<T>& ray, RayAccount<T>& account) const {
    Vec2<T> p;
    if (!meet(ray, p)) return RayStatus::missed_lens;
    account.weight = account.weight * ApertureStop<T>{radius, edge}.transmission(p.x, p.y);
    return p.x * p.x + p.y * p.y > radius * radius ? RayStatus::vignetted : RayStatus::alive;
  }

  template <class U>
  PosedStop<U> in_scalar() const {
    return {gladstone::in_scalar<U>(pose), U(radius), U(edge)};
  }
};

/// Ideal thin lens with any pose. Light propagates along its +z axis. It maps slopes exactly (collinear map), and hence
/// is free of aberrations for every object plane.
template <class T>
struct PosedThinLens {
  Pose<T> pose;
  T focal_length{};  ///< [m]

  GLADSTONE_HD bool meet(Ray<T> const& ray, Vec2<T>& place) const { return pose.meet(ray, place); }

  /// @return missed_lens if the ray does not travel in +z direction. Optical paths are undefined behind the lens.
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

/// OneOf over the types of several lists, of which each is a SurfaceTypes or a OneOf.
template <class... Lists>
struct OneOfLists;
template <class... All>
struct OneOfLists<SurfaceTypes<All...>> {
  using Type = OneOf<All...>;
};
template <template <class...> class List, class... First, template <class...> class Other, class... Second,
          class... Lists>
struct OneOfLists<List<First...>, Other<Second...>, Lists...>
    : OneOfLists<SurfaceTypes<First..., Second...>, Lists...> {};

/// Stop, ideal thin lens, surfaces of lenses, and surface types that only one kind of optical element defines.
template <class T, class Kinds>
struct CameraElements;
template <class T, class... Kinds>
struct CameraElements<T, ElementKinds<Kinds...>>
    : OneOfLists<SurfaceTypes<PosedStop<T>, PosedThinLens<T>>, LensSurface<T>,
                 typename Kinds::template OwnSurfaces<T>...> {};

/// Closed set of everything that acts on a ray between a source and the sensor. Each contains its pose in the world,
/// accepts rays of any direction, and has `RayStatus interact(Ray<T>&, RayAccount<T>&) const`, meet() and in_scalar().
template <class T>
using CameraElement = typename CameraElements<T, AllElements>::Type;

/// Converts an element to another scalar type. With ceres::Jet, rays carry derivatives with respect to its pose and
/// shape.
template <class U, class... All>
CameraElement<U> in_scalar(OneOf<All...> const& element) {
  return element.visit([](auto const& held) -> CameraElement<U> { return held.template in_scalar<U>(); });
}

/// Traces a ray through an element of a known type. The weight becomes 0 if the ray ends there, except at a stop, whose
/// smoothed rim transmits part of the light of vignetted rays.
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

/// Traces a ray through an element, ignoring vignetting.
/// @return false if the ray is lost
GLADSTONE_HD inline bool trace_ignoring_vignetting(CameraElement<double> const& element, Ray<double>& ray) {
  RayAccount<double> account;
  RayStatus const status = element.visit([&](auto const& held) { return held.interact(ray, account); });
  return status == RayStatus::alive || status == RayStatus::vignetted;
}

}  // namespace gladstone::inline optics
