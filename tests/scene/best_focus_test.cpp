#include "render/scene/best_focus.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "render/optics/ray_bundle.h"
#include "render/scene/build_camera.h"
#include "tests/scene/read_setup_text.h"
#include "tests/scene/real_lens_setups.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

/// Returns the position of the sensor at the paraxial image of the point in focus [m].
double from_paraxial_image(gladstone::Setup const& setup) {
  Camera const camera = build_camera(setup);
  RayTransfer const& m = camera.paraxial.whole;
  double const object = setup.focus_distance() + camera.paraxial.front;
  double const image = -(m.a * object + m.b) / (m.c * object + m.d);
  Pose<double> const behind = camera.paraxial.behind.within(camera.pose);
  return behind.point_to_local(camera.sensor.pose.origin).z - image;
}

// For a lens corrected for spherical aberration on its axis, the best focus tends to the paraxial focus as the aperture
// decreases: the difference is proportional to the square of the aperture, so that halving the aperture divides it by
// four, up to terms of the next order, which decrease four times faster. At f/16, these are 1e-3 of the difference, as
// the listing of the double Gauss shows: its aberrations at heights of 5 and 10 mm (f/10, f/5) have a ratio of 3.8.
TEST(BestFocus, TendsToTheParaxialFocusAsTheApertureShrinks) {
  for (char const* const lens : {"double_gauss", "achromat"}) {
    double const wide = from_paraxial_image(real_lens_setup(lens, 64, 16)),
                 half = from_paraxial_image(real_lens_setup(lens, 64, 32)),
                 quarter = from_paraxial_image(real_lens_setup(lens, 64, 64));
    EXPECT_GT(std::abs(wide), 1e-7) << lens;
    EXPECT_NEAR(wide / half, 4, 0.1) << lens;
    EXPECT_NEAR(half / quarter, 4, 0.025) << lens;  // next-order terms, and so the tolerance, divided by four
  }
}

/// Returns the mean square radius, on the sensor, of the ray bundle of a point on the axis [m^2].
double mean_square_on_sensor(Camera const& camera, Vec3d point) {
  auto const disc = camera.apparent_pupil(point);
  std::vector<Vec2d> places, slopes;
  for (int k = 0; k < 500; ++k) {
    Vec2d const at = sunflower(k, 500);
    Ray<double> ray{point, normalized(disc->centre + at.x * disc->a + at.y * disc->b - point)};
    RayAccount<double> account;
    CameraView<double> const view = camera.view();
    Vec2d place;
    if (carry(view, 0, view.count, ray, account) != RayStatus::alive || !camera.sensor.meet(ray, place)) continue;
    places.push_back(place);
    slopes.push_back({});
  }
  return compute_bundle_spot(places, slopes).mean_square;
}

gladstone::Setup with_sensor_at(gladstone::Setup setup, double z_sensor) {
  setup.z_sensor = z_sensor;
  position_lens_from_sensor(setup);
  return setup;
}

// Bessel: if an object and a screen are L apart, a lens of focal length f images one onto the other at distances (L +-
// sqrt(L^2 - 4 L f)) / 2; the position closer to the screen has the smaller image. For L < 4 f there is no image.
TEST(LensPlacedBySensor, OfAThinLensIsBessels) {
  gladstone::Setup const setup = with_sensor_at(table1_setup(64), 0.87);
  double const L = 0.87 + 0.25, v = (L - std::sqrt(L * L - 4 * L * 0.105)) / 2;
  EXPECT_NEAR(setup.z_a, 0.87 - v, 1e-15);
  Camera const camera = build_camera(setup);
  EXPECT_NEAR(camera.sensor.pose.origin.z, 0.87, 1e-15);
  EXPECT_THAT([&] { with_sensor_at(table1_setup(64), 0.16); },
              ThrowsDataError(ErrorCode::invalid_value, "geometry.z_sensor_mm"));
  // at a fixed distance of the object from the lens, 1/f - 1/u alone determines the position
  gladstone::Setup near = table1_setup(64);
  near.lens.focus = Focus::distance;
  near.lens.focus_distance = 0.6;
  EXPECT_NEAR(with_sensor_at(near, 0.87).z_a, 0.87 - 1 / (1 / 0.105 - 1 / 0.6), 1e-15);
}

// A real lens behind a window: at the position found, the best focus of the camera is the position of the sensor, and
// moving the sensor in either direction widens the bundle of the point in focus.
TEST(LensPlacedBySensor, OfARealLensIsWhereTheSensorSeesTheNarrowestBundle) {
  gladstone::Setup base = double_gauss_setup(64, 2.8);
  OpticalWindow window;
  window.index = 1.5168;
  window.thickness = 10e-3;
  window.position = {0, 0, 0.1};
  base.elements = {window};
  for (Focus const focus : {Focus::target, Focus::distance}) {
    base.lens.focus = focus;
    base.lens.focus_distance = 0.9;
    gladstone::Setup const setup = with_sensor_at(base, 0.87);
    Camera camera = build_camera(setup);
    EXPECT_NEAR(camera.sensor.pose.origin.z, 0.87, 1e-10);
    Vec3d const point{0, 0, setup.z_a - setup.focus_distance()};
    if (focus == Focus::target) {
      EXPECT_NEAR(point.z, -setup.z_d, 1e-15);
    }
    double const best = mean_square_on_sensor(camera, point);
    for (double const moved : {-20e-6, -5e-6, 5e-6, 20e-6}) {
      Camera other = camera;
      other.sensor.pose = camera.sensor.pose.moved({0, 0, moved});
      EXPECT_GT(mean_square_on_sensor(other, point), best) << moved;
    }
  }
}

// The key of the setup, and its conflicts with other keys that position the lens.
TEST(LensPlacedBySensor, IsReadFromTheSetup) {
  auto const read = [](std::string const& text) { return read_setup_text(text).setup; };
  gladstone::Setup const setup = read("[geometry]\nz_sensor_mm = 870\n");
  EXPECT_NEAR(build_camera(setup).sensor.pose.origin.z, 0.87, 1e-12);
  EXPECT_THAT([&] { read("[geometry]\nz_sensor_mm = 870\nz_a_mm = 750\n"); }, refused(ErrorCode::invalid_value, "3:1"));
  EXPECT_THAT([&] { read("[geometry]\nz_sensor_mm = 150\n"); }, refused(ErrorCode::invalid_value, "2:1"));
}

}  // namespace
}  // namespace gladstone
