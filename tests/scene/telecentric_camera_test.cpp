#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "render/optics/paraxial.h"
#include "render/scene/build_camera.h"
#include "tests/scene/read_setup_text.h"

namespace gladstone {
namespace {

/// The shipped lens, telecentric at 587.6 nm and approximately at 532 nm. At its working distance, 1160 mm in front of
/// its first vertex, the magnification is 0.2.
std::string telecentric(std::string const& f_number, std::string const& place = "z_front_mm = 960.0") {
  return "[camera]\npixels = [256, 256]\npixel_pitch_um = 20.0\n[lens]\nmodel = \"prescription\"\nfile = \"" +
         std::string(GLADSTONE_DATA_DIR) + "/lenses/telecentric.toml\"\n" + f_number + "[geometry]\n" + place +
         "\nz_d_mm = 200.0\n";
}

gladstone::Setup telecentric_setup(std::string const& f_number = "") {
  return read_setup_text(telecentric(f_number)).setup;
}

// Chief rays are parallel to the axis: a point that moves along the axis keeps its position in the image. If it moves
// by 0.3 m, a perspective camera at 1.16 m would show it a third larger, or a fifth smaller.
TEST(TelecentricCamera, ShowsPointsWhereTheyAreAtAnyDistance) {
  gladstone::Setup const setup = telecentric_setup();
  EXPECT_NEAR(setup.imaging().magnification, 0.2, 0.004);
  Camera const camera = build_camera(setup);
  Vec2d const axis = camera.sensor.axis_pixel();
  for (Vec2d const at : {Vec2d{8e-3, 0}, {-5e-3, 9e-3}}) {
    auto const here = camera.project({at.x, at.y, -0.2});
    ASSERT_TRUE(here);
    EXPECT_NEAR(length(*here - axis) / (0.2 * length(at) / 20e-6), 1, 0.02);
    for (double const z : {-0.5, 0.1}) {
      auto const there = camera.project({at.x, at.y, z});
      ASSERT_TRUE(there);
      // at 532 nm, the pupil is some tens of metres away: 0.3 m change the image by less than a hundredth
      EXPECT_NEAR(length(*there - axis) / length(*here - axis), 1, 0.01);
    }
  }
}

// The entrance pupil is found by ray tracing: its rays fill the stop, and the chief ray of any point of the target is
// parallel to the axis.
TEST(TelecentricCamera, AimsAtItsStopThoughItsPupilIsInfinitelyFar) {
  gladstone::Setup const setup = telecentric_setup();
  Camera const camera = build_camera(setup);
  for (Vec3d const source : {Vec3d{0, 0, -0.2}, {8e-3, -8e-3, -0.2}}) {
    auto const disc = camera.apparent_pupil(source);
    ASSERT_TRUE(disc);
    Vec3d const chief = disc->centre - source;
    EXPECT_LT(std::hypot(chief.x, chief.y) / chief.z, 1e-3);
    for (Vec3d const rim : {disc->a, disc->b, -1.0 * disc->a, -1.0 * disc->b}) {
      for (double const share : {0.97, 1.03}) {
        Vec3d const aim = disc->centre + share / Camera::pupil_safety_factor() * rim;
        RayHit<double> const hit = trace_ray(camera.view(), NoMedium<double>{}, TracingOptions<double>{},
                                             Ray<double>{source, normalized(aim - source)}, 1.0);
        EXPECT_EQ(hit.status == RayStatus::vignetted, share > 1);
      }
    }
  }
}

// The f-number of such a lens is the working one, of the light cone that converges on an image point: 1 / (2 tan u').
TEST(TelecentricCamera, FNumberSetsTheStopByTheConeOfLightInTheImage) {
  double last = 0;
  for (double const N : {8.0, 16.0}) {
    gladstone::Setup const setup = telecentric_setup("f_number = " + std::to_string(N) + "\n");
    Camera const camera = build_camera(setup);
    Vec3d const source{0, 0, -0.2};
    auto const disc = camera.apparent_pupil(source);
    ASSERT_TRUE(disc);
    Ray<double> rim{source, normalized(disc->centre + 1 / Camera::pupil_safety_factor() * disc->a - source)};
    for (auto const& element : camera.elements) {
      RayAccount<double> account;
      pass_element(element, rim, account);
    }
    double const slope = std::hypot(rim.direction.x, rim.direction.y) / rim.direction.z;
    // the rim ray has an aberration of third order in its slope
    EXPECT_NEAR(2 * N * slope, 1, 0.01) << N;
    EXPECT_NEAR(setup.imaging().image_distance / setup.imaging().entrance_pupil, N, 0.005 * N);
    if (last > 0) {
      EXPECT_NEAR(last / setup.lens.prescription->stop_radius, 2, 0.01);
    }
    last = setup.lens.prescription->stop_radius;
  }
}

// Such a lens cannot be positioned by its principal plane.
TEST(TelecentricCamera, IsPlacedByItsFirstVertexAlone) {
  EXPECT_THAT([] { read_setup_text(telecentric("", "z_a_mm = 960.0")); }, refused(ErrorCode::invalid_value, "8:1"));
  ParaxialLens const paraxial = paraxial_lens(*telecentric_setup().lens.prescription);
  EXPECT_TRUE(paraxial.telecentric);
  EXPECT_TRUE(std::isinf(paraxial.f_number));
}

}  // namespace
}  // namespace gladstone
