#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "render/focused_dots/focused_dots.h"
#include "render/optics/ray_bundle.h"
#include "render/scene/build_camera.h"
#include "render/scene/scene.h"
#include "tests/scene/read_setup_text.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

constexpr double pitch = 130e-6, lenslet_f = 1.5e-3;

/// Table 1 with lenslets in the image plane.
gladstone::Setup plenoptic_setup() {
  gladstone::Setup setup = table1_setup(512);
  setup.elements = {LensletSetup{pitch, lenslet_f, lenslet_f, LensletLayout::square}};
  return setup;
}

/// Returns the positions on the sensor, relative to the axis pixel, of rays of a point through the whole stop [m].
std::vector<Vec2d> landings(Camera const& camera, Vec3d point) {
  auto const disc = camera.apparent_pupil(point);
  std::vector<Vec2d> places;
  for (int k = 0; k < 2000; ++k) {
    Vec2d const at = sunflower(k, 2000);
    Vec3d const aim = disc->centre + at.x * disc->a + at.y * disc->b;
    RayHit<double> const hit = trace_ray(camera.view(), NoMedium<double>{}, TracingOptions<double>{},
                                         Ray<double>{point, normalized(aim - point)}, 1.0);
    if (reaches_sensor_plane(hit.status)) {
      places.push_back(camera.sensor.pitch * (hit.pixel - camera.sensor.axis_pixel()));
    }
  }
  return places;
}

// A point in focus is imaged to one point of the lenslet array: its light passes one lenslet, which images the stop as
// a disc as wide as the light cone behind the array, D_a / z_i times the distance from the sensor.
TEST(PlenopticCamera, ShowsTheStopBehindTheLensletOfAPoint) {
  gladstone::Setup const setup = plenoptic_setup();
  Camera const camera = build_camera(setup);
  double const z_i = setup.imaging().image_distance, M = setup.imaging().magnification;
  EXPECT_NEAR(camera.sensor.pose.origin.z, 0.75 + z_i + lenslet_f, 1e-12);
  Vec2d const lenslet{3 * pitch, -2 * pitch};  // position in the stored, upright image
  std::vector<Vec2d> const places = landings(camera, {lenslet.x / M, -lenslet.y / M, -0.25});
  ASSERT_GT(places.size(), 1500u);
  double const radius = 0.105 / 11 / 2 / z_i * lenslet_f;
  // as seen from the lenslet, the centre of the stop is displaced by the lenslet's position over z_i
  Vec2d const middle = (1 + lenslet_f / z_i) * lenslet;
  double widest = 0;
  for (Vec2d const at : places) widest = std::max(widest, length(at - middle));
  // 2000 uniformly distributed points leave a gap at the rim of at most their spacing, sqrt(pi / 2000) of the radius
  EXPECT_LE(widest, radius * (1 + 1e-9));
  EXPECT_GT(widest, radius * (1 - 0.04));
}

// The light of a point nearer than the plane in focus spreads over several lenslets, each of which images the part of
// the stop from which it is illuminated. The expected position of each ray is computed by the thin-lens formula, first
// for the main lens, then for the lenslet about its own axis.
TEST(PlenopticCamera, SortsLightByWhereItPassedTheStop) {
  gladstone::Setup const setup = plenoptic_setup();
  Camera const camera = build_camera(setup);
  double const z_i = setup.imaging().image_distance, f = setup.lens.focal_length;
  Vec3d const point{0.004, -0.003, 0.1};
  double const u = 0.75 - point.z, v = 1 / (1 / f - 1 / u);  // distance of its image behind the lens
  int lenslets = 0;
  Vec2d last{1, 1};
  for (Vec2d const stop : {Vec2d{0, 0}, {0.002, 0}, {-0.002, 0.003}, {0.0, -0.004}, {0.0035, 0.0025}}) {
    Vec3d const aim{stop.x, stop.y, 0.75};
    RayHit<double> const hit = trace_ray(camera.view(), NoMedium<double>{}, TracingOptions<double>{},
                                         Ray<double>{point, normalized(aim - point)}, 1.0);
    ASSERT_TRUE(reaches_sensor_plane(hit.status));
    // from the stop towards the image at -v/u (x, y), to the array, refracted by the lenslet, to the sensor
    Vec2d const image{-v / u * point.x, -v / u * point.y}, slope = (image - stop) / v;
    Vec2d const at_array = stop + z_i * slope;
    Vec2d const axis{pitch * std::round(at_array.x / pitch), pitch * std::round(at_array.y / pitch)};
    Vec2d const on_sensor = axis + lenslet_f * slope;  // in the focal plane, the position depends on the slope only
    Vec2d const expected{-on_sensor.x / 10e-6, on_sensor.y / 10e-6};
    EXPECT_NEAR(length(hit.pixel - camera.sensor.axis_pixel() - expected), 0, 1e-8);
    lenslets += length(axis - last) > 0 ? 1 : 0;
    last = axis;
  }
  EXPECT_GE(lenslets, 3);
}

// Lenslets redistribute light but block none: the same rays reach the sensor's plane as without them.
TEST(PlenopticCamera, LosesNoLight) {
  gladstone::Setup setup = plenoptic_setup();
  Vec3d const point{0.01, 0.005, -0.2};
  std::size_t const with = landings(build_camera(setup), point).size();
  setup.elements.clear();
  EXPECT_EQ(with, landings(build_camera(setup), point).size());
}

// The images of the stop, d D_a / z_i wide, must not exceed the pitch of the lenslets. For 105 mm f/11 in focus at 1 m,
// z_i / D_a = 12.29, so that their diameter is 122 um at a distance of 1.5 mm.
TEST(PlenopticCamera, IsToldWhereItsPicturesOverlap) {
  auto const warnings = [](char const* pitch_um) {
    return read_setup_text(std::string("[camera.lenslets]\nfocal_length_um = 1500\npitch_um = ") + pitch_um + "\n")
        .warnings;
  };
  EXPECT_THAT(warnings("123"), testing::Not(testing::Contains(testing::Field(&Warning::place, "lenslets"))));
  EXPECT_THAT(warnings("121"), testing::Contains(Warns("unsuitable at lenslets", testing::HasSubstr("122 um"))));
}

// The PSF is that of a lenslet's light cone: wavelength times its distance over its pitch.
TEST(PlenopticCamera, HasTheLensletsSpot) {
  gladstone::Setup const setup = plenoptic_setup();
  EXPECT_NEAR(setup.spot_scale_px(), lenslet_f / pitch * 532e-9 / 10e-6, 1e-12);
  EXPECT_FALSE(setup.has_closed_form_layout());
  EXPECT_NE(reason_against_focused_dots(setup), "");
}

}  // namespace
}  // namespace gladstone
