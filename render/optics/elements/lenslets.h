#pragma once

#include <cmath>
#include <optional>
#include <string>

#include "render/base/in_scalar.h"
#include "render/base/pose.h"
#include "render/base/warning.h"
#include "render/optics/element_side.h"
#include "render/optics/lens_surface.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline optics {

struct ImagingGeometry;

enum class LensletLayout : int { square, hexagonal };

/// Plane array of equal, ideal thin lenses without gaps, each exact in slopes about its own axis like PosedThinLens.
/// One lenslet is centred on the axis; rows are along x. In a hexagonal layout, rows are sqrt(3)/2 pitches apart and
/// every other row is shifted by half a pitch. A point belongs to the lenslet with the nearest axis.
template <class T>
struct LensletArray {
  static constexpr bool divides_light = true;  ///< forms many images, each with a part of the light of a point

  Pose<T> pose;
  T pitch{};         ///< distance between neighbouring axes [m]
  T focal_length{};  ///< [m]
  LensletLayout layout = LensletLayout::square;

  GLADSTONE_HD bool meet(Ray<T> const& ray, Vec2<T>& place) const { return pose.meet(ray, place); }

  /// Returns the axis position, in the plane, of the lenslet that a point belongs to [m].
  GLADSTONE_HD Vec2<T> axis_at(Vec2<T> place) const {
    if (layout == LensletLayout::square) return {nearest(place.x, pitch), nearest(place.y, pitch)};
    // a hexagonal lattice consists of two rectangular ones, shifted by half a cell
    T const height = T(1.7320508075688772) * pitch;
    Vec2<T> const first{nearest(place.x, pitch), nearest(place.y, height)};
    Vec2<T> const middle{T(0.5) * pitch, T(0.5) * height};
    Vec2<T> const second{nearest(place.x - middle.x, pitch) + middle.x, nearest(place.y - middle.y, height) + middle.y};
    Vec2<T> const to_first = place - first, to_second = place - second;
    return dot(to_second, to_second) < dot(to_first, to_first) ? second : first;
  }

  /// @return missed_lens if the ray does not travel in +z direction. Optical paths are undefined behind the array.
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

/// Array of lenslets in the image plane of the lens, ahead of the sensor (plenoptic camera), in SI.
struct LensletSetup {
  static constexpr char const* kind = "lenslets";
  static constexpr char const* camera_table = "lenslets";
  static constexpr ElementSide side = ElementSide::image_plane;
  static constexpr bool divides_light = true;
  template <class T>
  using OwnSurfaces = SurfaceTypes<LensletArray<T>>;

  double pitch = 0;         ///< [m]
  double focal_length = 0;  ///< [m]
  double to_sensor = 0;     ///< distance from the array to the sensor [m]
  LensletLayout layout = LensletLayout::square;

  /// Reads the keys. The focal length is given directly, or by the radius of the one curved face and the index at the
  /// setup's wavelength, f = R / (n - 1).
  static LensletSetup read(SetupTable& table);

  /// f-number of the images that the lenslets form on the sensor, on which their diffraction depends [1].
  double image_f_number() const { return to_sensor / pitch; }
  /// Warns if the images of the stop behind the lenslets overlap. To avoid this, the f-number of the lenslets must not
  /// exceed that of the lens (Ng et al., Stanford Tech Report CTSR 2005-02, section 3.1). @return nullopt: no warning
  std::optional<Warning> imaging_warning(ImagingGeometry const& imaging, double f_number) const;

  template <class Add>
  void add_surfaces(Pose<double> const& at, bool, Add const& add) const {
    add(LensletArray<double>{at, pitch, focal_length, layout}, "");
  }
};

}  // namespace gladstone::inline optics
