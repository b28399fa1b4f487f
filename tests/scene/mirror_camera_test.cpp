#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <string>

#include "render/scene/build_camera.h"
#include "tests/scene/read_setup_text.h"

namespace gladstone {
namespace {

/// Returns a camera with a lens from a separate file, whose first vertex is 2 m in front of the medium; the dots are
/// 0.25 m behind it.
Camera camera_with(std::string const& name, std::string const& surfaces) {
  std::filesystem::path const file = std::filesystem::path(testing::TempDir()) / ("gladstone_" + name + ".toml");
  std::ofstream(file) << "schema = 1\nentrance_pupil_mm = 10.0\n" << surfaces;
  gladstone::Setup const setup =
      read_setup_text(
          "[camera]\npixels = [256, 256]\npixel_pitch_um = 10.0\n[lens]\nmodel = \"prescription\"\nfile = \"" +
          file.string() + "\"\n[geometry]\nz_front_mm = 2000\nz_d_mm = 250.0\n")
          .setup;
  std::filesystem::remove(file);
  return build_camera(setup);
}

/// Returns the distance of a point of the dots' plane from the axis pixel in the image [px].
double off_axis_px(Camera const& camera, Vec2d at) {
  auto const pixel = camera.project({at.x, at.y, -0.25});
  EXPECT_TRUE(pixel);
  return pixel ? length(*pixel - camera.sensor.axis_pixel()) : std::nan("");
}

// A concave mirror of f = 200 mm with the stop at its vertex: the image of a plane at the distance s = 2250 mm is s' =
// 1/(1/200 - 1/2250) mm in front of it. Chief rays are reflected at the vertex, so that image heights are proportional
// to the distances. An ellipsoid with foci at these points, e = (s - s')/(s + s') = 37/45, images one onto the other
// through the whole stop.
TEST(MirrorCamera, ImagesByOneMirror) {
  Camera const camera = camera_with(
      "one_mirror", "[[surface]]\nradius_mm = -400.0\nconic = -0.67604938271604938\nglass = \"mirror\"\nstop = true\n");
  double const image = 1 / (1 / 0.2 - 1 / 2.25);
  EXPECT_NEAR(camera.sensor.pose.origin.z, 2.0 - image, 1e-9);
  for (Vec2d const at : {Vec2d{5e-3, 0}, {0, -7e-3}, {4e-3, 3e-3}}) {
    EXPECT_NEAR(off_axis_px(camera, at), image / 2.25 * length(at) / 10e-6, 1e-5 * length(at) / 10e-6);
  }
}

// Flat mirrors only fold the light path: a lens followed by one, two or three of them images as without them.
TEST(MirrorCamera, SeesThroughFoldsAsWithoutThem) {
  std::string const lens =
      "[[surface]]\nradius_mm = 100\nthickness_mm = 4\nglass = \"N-BK7\"\nstop = true\n"
      "[[surface]]\nradius_mm = -100\nthickness_mm = 40\n";
  std::string const back = "[[surface]]\nglass = \"mirror\"\nthickness_mm = -10\n";
  std::string const forth = "[[surface]]\nglass = \"mirror\"\nthickness_mm = 10\n";
  Camera const straight = camera_with("no_fold", lens);
  for (auto const& [name, folds] :
       {std::pair{"one_fold", back}, {"two_folds", back + forth}, {"three_folds", back + forth + back}}) {
    Camera const folded = camera_with(name, lens + folds);
    for (Vec2d const at : {Vec2d{5e-3, 0}, {0, -7e-3}, {4e-3, 3e-3}}) {
      // the position of the sensor is found to about 1e-9 of its distance
      EXPECT_NEAR(off_axis_px(folded, at), off_axis_px(straight, at), 1e-6) << name;
    }
  }
}

}  // namespace
}  // namespace gladstone
