#pragma once

#include <type_traits>

#include "render/medium/fields/slab.h"
#include "render/medium/trace_medium.h"
#include "render/optics/camera_element.h"
#include "render/scene/ray_hit.h"
#include "render/sensor/posed_sensor.h"

namespace gladstone::inline scene {

/// Optical elements and sensor on a ray's path: a non-owning view, passed by value.
template <class T>
struct CameraView {
  CameraElement<T> const* elements = nullptr;
  int before_medium = 0;  ///< number of elements in front of the medium
  int count = 0;
  PosedSensor<T> sensor;
  Pose<T> aim_plane;  ///< plane at which rays are aimed: tangent to the first surface of the lens
};

/// Traces N rays through elements [first, last), as long as their weight is not zero.
/// The rays are processed together: a surface is one long chain of dependent operations, and those of several rays
/// overlap in the processor's pipeline.
/// @param status  status of each ray; unchanged unless an element blocks the ray
template <class T, int N>
GLADSTONE_HD void carry(CameraView<T> const& camera, int first, int last, Ray<T> (&ray)[N], RayAccount<T> (&account)[N],
                        RayStatus (&status)[N]) {
  for (int i = first; i < last; ++i) {
    camera.elements[i].visit([&](auto const& held) {
      for (int k = 0; k < N; ++k) {
        if (account[k].weight == T(0)) continue;
        RayStatus const here = pass(held, ray[k], account[k]);
        if (here != RayStatus::alive) status[k] = here;
      }
    });
  }
}

/// Traces one ray through elements [first, last).
template <class T>
GLADSTONE_HD RayStatus carry(CameraView<T> const& camera, int first, int last, Ray<T>& ray, RayAccount<T>& account) {
  RayStatus status = RayStatus::alive;
  for (int i = first; i < last && account.weight != T(0); ++i) {
    RayStatus const here = pass_element(camera.elements[i], ray, account);
    if (here != RayStatus::alive) status = here;
  }
  return status;
}

/// Traces one ray through elements [first, last), ignoring vignetting.
/// @return false if the ray is lost
GLADSTONE_HD inline bool carry_ignoring_vignetting(CameraView<double> const& camera, int first, int last,
                                                   Ray<double>& ray) {
  for (int i = first; i < last; ++i) {
    if (!trace_ignoring_vignetting(camera.elements[i], ray)) return false;
  }
  return true;
}

/// Returns the straight ray behind the medium; the incoming ray itself if it was not deflected.
template <class T>
GLADSTONE_HD Ray<T> outgoing_ray(Ray<T> const& start, MediumPassage<T> const& way) {
  if (!way.crossed || (way.turn == Vec3<T>{} && way.shift == Vec3<T>{})) return start;
  return {exit_position(start, way), exit_direction(start, way)};
}

/// Traces rays from the medium through the remaining elements to the sensor's plane.
/// @param status  status of each ray so far
template <class T, int N>
GLADSTONE_HD void finish_rays(CameraView<T> const& camera, Ray<T> (&ray)[N], RayAccount<T> (&account)[N],
                              RayStatus (&status)[N], RayHit<T> (&hit)[N]) {
  for (int i = 0; i < N; ++i) {
    hit[i] = {};
    if (account[i].weight != T(0)) camera.aim_plane.meet(ray[i], hit[i].at_lens);
  }
  carry(camera, camera.before_medium, camera.count, ray, account, status);
  for (int i = 0; i < N; ++i) {
    hit[i].status = status[i];
    hit[i].weight = account[i].weight;
    if (hit[i].weight == T(0)) continue;
    Vec2<T> place;
    if (!camera.sensor.meet(ray[i], place)) {
      hit[i].status = RayStatus::missed_lens;
      hit[i].weight = T(0);
      continue;
    }
    hit[i].pixel = camera.sensor.to_pixel(place.x, place.y);
    if (hit[i].status == RayStatus::alive && !camera.sensor.covers(hit[i].pixel))
      hit[i].status = RayStatus::missed_sensor;
  }
}

/// Traces N rays of one image together: elements in front of the medium, medium, remaining elements, sensor.
/// The type of the medium is that of the image; NoMedium is the ambient. A View may define its own finish_rays() to
/// determine where rays land.
template <class View, class T, class Medium, int N>
GLADSTONE_HD void trace_rays(View const& camera, Medium const& medium, TracingOptions<T> const& options,
                             Ray<T> const (&start)[N], T const (&weight)[N], RayHit<T> (&hit)[N]) {
  Ray<T> ray[N];
  RayAccount<T> account[N];
  RayStatus status[N];
  for (int i = 0; i < N; ++i) {
    ray[i] = start[i];
    account[i].weight = weight[i];
    status[i] = RayStatus::alive;
  }
  carry(camera, 0, camera.before_medium, ray, account, status);
  if constexpr (!std::is_same_v<Medium, NoMedium<T>>) {
    MediumPassage<T> way[N];
    trace_medium(medium, options, ray, way);
    for (int i = 0; i < N; ++i) {
      if (way[i].status != RayStatus::alive && account[i].weight != T(0)) {
        status[i] = way[i].status;
        account[i].weight = T(0);
      }
      ray[i] = outgoing_ray(ray[i], way[i]);
    }
  }
  finish_rays(camera, ray, account, status, hit);
}

/// Traces one ray of one image.
template <class View, class T, class Medium>
GLADSTONE_HD RayHit<T> trace_ray(View const& camera, Medium const& medium, TracingOptions<T> const& options,
                                 Ray<T> const& start, T weight) {
  Ray<T> const rays[1] = {start};
  T const weights[1] = {weight};
  RayHit<T> hit[1];
  trace_rays(camera, medium, options, rays, weights, hit);
  return hit[0];
}

}  // namespace gladstone::inline scene
