#include "render/scene/calibration_planes.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "render/light/calibration_target.h"
#include "render/scene/build_camera.h"
#include "tests/scene/read_setup_text.h"

namespace gladstone {
namespace {

std::string calibration(std::string const& more = "", std::string const& table = "") {
  return "experiment = \"calibration\"\n[calibration]\n" + table + more;
}

/// Returns the pixel of a point by OpenCV's formulae of a pinhole camera.
Vec2d project(Pinhole const& pinhole, Vec3d world) {
  Vec3d const d{dot(pinhole.rows[0], world) + pinhole.translation.x,
                dot(pinhole.rows[1], world) + pinhole.translation.y,
                dot(pinhole.rows[2], world) + pinhole.translation.z};
  Vec2d const at{d.x / d.z, d.y / d.z}, moved = at + pinhole.brown.shift(at);
  return {pinhole.fx * moved.x + pinhole.cx, pinhole.fy * moved.y + pinhole.cy};
}

// A thin lens is a pinhole camera at any pose, with a perpendicular or tilted sensor, and with distortion.
TEST(CalibrationPlanes, AThinLensIsAPinholeCamera) {
  std::string const posed = "[camera.pose]\nposition_mm = [200, 100, 700]\nroll_deg = 7\n";
  for (std::string const& more : {std::string(), posed, posed + "[camera.sensor]\nscheimpflug = \"auto\"\n",
                                  std::string("[camera.sensor]\ntilt_deg = [4, -3]\n"),
                                  posed + "[camera.sensor]\ndistortion = [0.3, -2.0, 0.004, -0.002]\n"}) {
    gladstone::Setup const setup = read_setup_text(calibration(more)).setup;
    Camera const camera = build_camera(setup);
    auto const pinhole = equivalent_pinhole(setup, camera);
    ASSERT_TRUE(pinhole) << more;
    for (Vec3d const at : {Vec3d{}, Vec3d{0.01, -0.007, 0.002}, Vec3d{-0.012, 0.01, -0.005}}) {
      auto const seen = camera.project(at);
      ASSERT_TRUE(seen) << more;
      EXPECT_LT(length(*seen - project(*pinhole, at)), 1e-7) << more;  // project() stops at 1e-9 of the stop's radius
    }
  }
}

TEST(CalibrationPlanes, NonPinholeCameraIsDetected) {
  for (std::string const& more : {std::string("[[window]]\nposition_mm = [0, 0, 300]\n"),
                                  std::string("[camera.sensor]\ntilt_deg = [4, 0]\ndistortion = [0.1, 0, 0, 0]\n")}) {
    gladstone::Setup const setup = read_setup_text(calibration(more)).setup;
    EXPECT_FALSE(equivalent_pinhole(setup, build_camera(setup))) << more;
  }
}

// The camera's focus, tilt and position are those for Z = 0, whichever plane contains the dots.
TEST(CalibrationPlanes, AllPlanesAreSeenByOneCamera) {
  gladstone::Setup const setup =
      read_setup_text(calibration("[camera.pose]\nposition_mm = [300, 0, 700]\n[camera.sensor]\n"
                                  "scheimpflug = \"auto\"\n[[window]]\nposition_mm = [0, 0, 200]\n"))
          .setup;
  Camera const camera = build_camera(setup);
  for (double const z : {-0.02, 0.015}) {
    gladstone::Setup const plane = plane_setup(setup, z);
    Camera const same = build_camera(plane);
    EXPECT_EQ(plane.z_d, -z);
    EXPECT_LT(length(same.sensor.pose.origin - camera.sensor.pose.origin), 1e-15);
    EXPECT_LT(length(same.sensor.pose.z - camera.sensor.pose.z), 1e-15);
    auto const a = same.project({0.004, 0.003, z}), b = camera.project({0.004, 0.003, z});
    ASSERT_TRUE(a && b);
    EXPECT_LT(length(*a - *b), 1e-9);
  }
}

TEST(CalibrationTarget, ItsMiddleDotIsTheOrigin) {
  gladstone::Setup const setup =
      read_setup_text(calibration("", "spacing_mm = 3.0\nextent_mm = [40.0, 12.0]\nplanes_mm = [1.0, -4.0]\n")).setup;
  Lattice const lattice(setup.target);
  EXPECT_EQ(lattice.half_columns, 6);  // 18 of 20 mm
  EXPECT_EQ(lattice.half_rows, 2);     // dots exactly on the edge
  std::vector<Vec2d> const dots = lattice.dots();
  ASSERT_EQ(dots.size(), 13u * 5u);
  for (std::size_t k = 0; k < dots.size(); ++k) {
    EXPECT_EQ(dots[k], (Vec2d{3e-3 * lattice.column(k), 3e-3 * lattice.row(k)}));
  }
  EXPECT_EQ(dots[32], Vec2d{});
  EXPECT_EQ(setup.planes, (std::vector<double>{1e-3, -4e-3}));
}

TEST(CalibrationSetup, MistakesAreNamedWithTheirCure) {
  auto const text = [](std::string const& line) { return calibration("", line + "\n"); };
  EXPECT_THAT([&] { read_setup_text(text("planes_mm = [0, 1, 0]")); }, refused(ErrorCode::invalid_value, "3:1"));
  EXPECT_THAT([&] { read_setup_text(text("dot_diameter_mm = 2.4")); }, refused(ErrorCode::invalid_value, "3:1"));
  EXPECT_THAT([&] { read_setup_text(text("spacing_mm = 1e-3\ndot_diameter_mm = 1e-4")); },
              refused(ErrorCode::invalid_value, "3:1"));
  EXPECT_THAT([&] { read_setup_text(text("planes_mm = [0, 700]")); }, refused(ErrorCode::invalid_value, "3:1"));
  EXPECT_THAT([&] { read_setup_text(text("planes_mm = [0, 50]\n[[window]]\nposition_mm = [0, 0, 40]")); },
              refused(ErrorCode::invalid_value, "3:1", "Z = 40 mm"));
  EXPECT_THAT([&] { read_setup_text(text("[geometry]\nz_d_mm = 250")); }, refused(ErrorCode::invalid_value, "4:1"));
  EXPECT_THAT([&] { read_setup_text(text("[target]\nseed = 1")); }, refused(ErrorCode::invalid_value, "3:"));
  EXPECT_THAT([&] { read_setup_text(text("[medium.field]\nkind = \"uniform_gradient\"\ngradient_kg_m4 = [1, 0, 0]")); },
              refused(ErrorCode::invalid_value, "3:"));
  EXPECT_THAT([] { read_setup_text("[calibration]\n"); }, refused(ErrorCode::invalid_value, "1:"));
}

// The wide-angle lens is 94 mm long and begins in front of its front principal plane, which is at Z = 300 mm: a plane
// 10 mm in front of that is inside the lens.
TEST(CalibrationPlanes, WithinALensAreRefused) {
  std::string const lens = "[lens]\nmodel = \"prescription\"\nfile = \"" + std::string(GLADSTONE_DATA_DIR) +
                           "/lenses/wide_angle.toml\"\n[geometry]\nz_a_mm = 300\n";
  EXPECT_NO_THROW(read_setup_text(calibration(lens, "planes_mm = [-10, 10]\n")));
  EXPECT_THAT([&] { read_setup_text(calibration(lens, "planes_mm = [-10, 290]\n")); },
              refused(ErrorCode::invalid_value, "3:1", "Z = 290 mm"));
}

}  // namespace
}  // namespace gladstone
