#pragma once

#include <cmath>
#include <optional>

#include "render/base/in_scalar.h"
#include "render/base/pose.h"
#include "render/base/setup_table.h"
#include "render/optics/lens_surface.h"

namespace gladstone {

enum class LensletLayout : int { square, hexagonal };

/// A plane of equal thin lenses side by side without gaps, each ideal: exact in slopes about its own axis, as
/// PosedThinLens. One stands on the axis; rows run along x. Of a hexagonal layout every other row is shifted by half a
/// pitch, rows sqrt(3)/2 of a pitch apart: a place belongs to the lens whose axis is nearest.
template <class T>
struct LensletArray {
  Pose<T> pose;
  T pitch{};         ///< from axis to axis [m]
  T focal_length{};  ///< [m]
  LensletLayout layout = LensletLayout::square;

  GLADSTONE_HD bool meet(Ray<T> const& ray, Vec2<T>& place) const { return pose.meet(ray, place); }

  /// Where the axis of the lens that a place belongs to meets the plane [m].
  GLADSTONE_HD Vec2<T> axis_at(Vec2<T> place) const {
    if (layout == LensletLayout::square) return {nearest(place.x, pitch), nearest(place.y, pitch)};
    // a hexagonal lattice is two rectangular ones, the second in the middles of the first
    T const height = T(1.7320508075688772) * pitch;
    Vec2<T> const first{nearest(place.x, pitch), nearest(place.y, height)};
    Vec2<T> const middle{T(0.5) * pitch, T(0.5) * height};
    Vec2<T> const second{nearest(place.x - middle.x, pitch) + middle.x, nearest(place.y - middle.y, height) + middle.y};
    Vec2<T> const to_first = place - first, to_second = place - second;
    return dot(to_second, to_second) < dot(to_first, to_first) ? second : first;
  }

  /// @return missed_lens for rays that do not run towards it; optical paths are undefined behind it
  GLADSTONE_HD RayStatus interact(Ray<T>& ray, RayAccount<T>&) const {
    Ray<T> const local = pose.inwards(ray);
    if (!(local.direction.z > T(0))) return RayStatus::missed_lens;
    T const sx = local.direction.x / local.direction.z, sy = local.direction.y / local.direction.z;
    Vec2<T> const place{local.position.x - sx * local.position.z, local.position.y - sy * local.position.z};
    Vec2<T> const from_axis = place - axis_at(place);
    Vec3<T> const turned{sx - from_axis.x / focal_length, sy - from_axis.y / focal_length, T(1)};
    ray = pose.outwards(Ray<T>{{place.x, place.y, T(0)}, normalized(turned)});
    return RayStatus::alive;
  }

  template <class U>
  LensletArray<U> in_scalar() const {
    return {gladstone::in_scalar<U>(pose), U(pitch), U(focal_length), layout};
  }

 private:
  GLADSTONE_HD static T nearest(T const& x, T const& spacing) {
    using std::floor;
    return spacing * floor(x / spacing + T(0.5));
  }
};

/// Table [camera.lenslets]: an array before the sensor, in SI.
struct LensletSetup {
  double pitch = 0;         ///< [m]
  double focal_length = 0;  ///< [m]
  double to_sensor = 0;     ///< from the array to the sensor behind it [m]
  LensletLayout layout = LensletLayout::square;
};

/// Reads the table; nothing where there is none. Lenslets have their focal length, or the radius of their one curved
/// face and their index at the setup's wavelength, f = R / (n - 1).
std::optional<LensletSetup> read_lenslets(SetupTable table);

}  // namespace gladstone
