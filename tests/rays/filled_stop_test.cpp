#include "render/rays/filled_stop.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/scene/real_lens_setups.h"

namespace gladstone {
namespace {

/// Returns a camera 750 mm in front of Z = 0 with a sharp stop. @param lens  of data/lenses; empty: an ideal one
Camera camera_with(std::string const& lens, double f_number) {
  auto setup = lens.empty() ? table1_setup(96) : real_lens_setup(lens, 96, f_number);
  setup.z_d = 0;
  setup.lens.f_number = f_number;
  return build_scene(setup).camera;
}

struct Filled : FilledStop {
  bool found;
};
Filled filled(Camera const& camera, Vec3d point) {
  StopView const view(camera);
  Filled result{};
  result.map = paraxial_aim(view, point);
  result.found = fill_stop(view, NoMedium<double>{}, {}, point, result);
  return result;
}

/// Point source with equal intensity in all directions.
struct Point {
  Vec3d at;
  Vec3d point(std::uint64_t, Vec2d) const { return at; }
  Vec3d middle(std::uint64_t) const { return at; }
  double intensity(std::uint64_t, Vec3d) const { return 1; }
};

// The stop of an ideal lens is in the aim plane: for 105 mm at f/4, its size is the same as seen from anywhere.
TEST(FillStop, OfAnIdealLensIsTheStop) {
  Camera const camera = camera_with("", 4);
  for (Vec3d const point : {Vec3d{}, Vec3d{30e-3, -10e-3, 20e-3}}) {
    Filled const stop = filled(camera, point);
    ASSERT_TRUE(stop.found);
    double const radius = 105e-3 / 8 * (1 - 1e-7);
    EXPECT_LT(length(stop.map.centre), 1e-14);
    EXPECT_LT(length(stop.map.a[0] - Vec2d{radius, 0}), 1e-14);
    EXPECT_LT(length(stop.map.b[0] - Vec2d{0, radius}), 1e-14);
    for (int m = 1; m < AimMap::orders; ++m) EXPECT_LT(length(stop.map.a[m]) + length(stop.map.b[m]), 1e-14);
  }
}

// The derivative of the map, compared with differences of 1e-5: to 1e-9 of the area.
TEST(FillStop, StretchesAsItMaps) {
  AimMap map;
  map.centre = {1, 2};
  for (int m = 0; m < AimMap::orders; ++m) {
    map.a[m] = {1.0 / (1 + 5 * m), 0.03 * m};
    map.b[m] = {-0.02 * m, 1.0 / (1 + 7 * m)};
  }
  double const h = 1e-5;
  for (Vec2d const at : {Vec2d{}, Vec2d{0.3, -0.7}, Vec2d{-0.6, 0.5}}) {
    Vec2d const by_x = (map.at(at + Vec2d{h, 0}) - map.at(at - Vec2d{h, 0})) / (2 * h),
                by_y = (map.at(at + Vec2d{0, h}) - map.at(at - Vec2d{0, h})) / (2 * h);
    EXPECT_NEAR(map.stretch(at), by_x.x * by_y.y - by_x.y * by_y.x, 1e-9);
  }
}

// Light of a point off the axis that passes a double Gauss at full aperture, by rays that fill the stop through the
// map, and by a fine grid of rays over the whole entrance pupil. The rim crosses about 3000 of the grid's 1000^2 cells
// at random positions, which causes an error of a third of sqrt(3000) cells of 780000: 2e-5. The error of the map is at
// most 6e-5; that of its 64^2 rays, at the centres of equal parts of radius squared and angle, is smaller.
TEST(FillStop, PassesTheLightThatARealLensTakes) {
  Camera const camera = camera_with("double_gauss", 2.8);
  for (Vec3d const point : {Vec3d{}, Vec3d{25e-3, 15e-3, 8e-3}}) {
    Filled const stop = filled(camera, point);
    ASSERT_TRUE(stop.found);
    Point const source{point};
    int const side = 64;
    double through_map = 0;
    for (int k = 0; k < side * side; ++k) {
      Vec2d const at = point_on_circle(std::sqrt((k / side + 0.5) / side), (k % side + 0.5) / side);
      AimedRay<double> const ray = ray_to(source, camera.aim_plane, stop.map, 0, at);
      RayHit<double> const hit = trace_ray(camera.view(), NoMedium<double>{}, {}, ray.ray, ray.weight);
      EXPECT_TRUE(reaches_sensor_plane(hit.status));
      through_map += hit.weight / (side * side);
    }
    int const cells = 1000;
    double const half = 1.05 * length(stop.map.a[0]);
    double over_plane = 0;
    for (int k = 0; k < cells * cells; ++k) {
      Vec2d const place =
          stop.map.centre + half * Vec2d{2 * (k % cells + 0.5) / cells - 1, 2 * (k / cells + 0.5) / cells - 1};
      AimedRay<double> const ray = ray_to_plane(source, camera.aim_plane, place, 4 * half * half, 0);
      over_plane +=
          trace_ray(camera.view(), NoMedium<double>{}, {}, ray.ray, ray.weight).weight / (1.0 * cells * cells);
    }
    EXPECT_NEAR(through_map / over_plane, 1, 1e-4);
  }
}

}  // namespace
}  // namespace gladstone
