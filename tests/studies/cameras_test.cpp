#include "studies/case/cameras.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "render/scene/particle_scene.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Two cameras to either side of the axis, the second one with a longer lens.
std::string two_cameras(std::string const& others) {
  return R"(schema = 1
[[camera]]
name = "left"
pixels = [64, 64]
pose.position_mm = [-132.3, 0.0, 750.0]
[[camera]]
name = "right"
pixels = [96, 64]
pose.position_mm = [132.3, 0.0, 750.0]
lens = { focal_length_mm = 120.0, f_number = 11.0 }
[lens]
focal_length_mm = 105.0
f_number = 11.0
[correlate]
window_px = [32, 16]
)" + others;
}

std::vector<CameraCase> load(std::string const& others, std::string const& first = "") {
  std::vector<CameraCase> cameras = load_cameras(SetupDocument::from_text(first + two_cameras(others), "setup.toml"));
  EXPECT_EQ(cameras.size(), 2u);
  return cameras;
}

/// Expects that a setup is that of its resolved text.
void expect_consistent(CaseSetup const& loaded) {
  CaseSetup const again = load_case_setup(SetupDocument::from_text(loaded.document.resolved(), "resolved.toml"));
  EXPECT_EQ(again.setup.target.extent_m, loaded.setup.target.extent_m);
  EXPECT_EQ(again.setup.target.centre_m, loaded.setup.target.centre_m);
  EXPECT_EQ(again.setup.target.dot_diameter_m, loaded.setup.target.dot_diameter_m);
  EXPECT_EQ(again.setup.target.dots_per_32px_window, loaded.setup.target.dots_per_32px_window);
}

// Each setup is read once. The resolved setup of a camera contains the common target instead of its own.
TEST(LoadedCameras, HaveTheTargetOfTheirResolvedSetups) {
  std::vector<CameraCase> const cameras =
      load("[geometry]\nz_d_mm = 250.0\n[target]\ndots_per_32px_window = 10.0\ndot_diameter_px = 3.0\n");
  gladstone::Setup const &left = cameras[0].loaded.setup, &right = cameras[1].loaded.setup;
  EXPECT_EQ(left.target_extent(), right.target_extent());
  EXPECT_EQ(left.dot_count(), right.dot_count());
  EXPECT_EQ(left.dot_diameter(), right.dot_diameter());
  for (CameraCase const& one : cameras) {
    expect_consistent(one.loaded);
    EXPECT_THAT(one.loaded.document.resolved(), Not(HasSubstr("dot_diameter_px")));
  }
}

TEST(LoadedCameras, HaveTheParticlesOfTheFirst) {
  std::vector<CameraCase> const cameras = load(
      "[particles]\nper_pixel = 0.05\nvolume_mm = [16.0, 12.0, 1.0]\nscattering = \"lambert\"\n"
      "[laser]\nthickness_mm = 0.5\n[flow]\nvelocity_m_s = [1.0, 0.0, 0.0]\ndt_us = 10.0\n",
      "experiment = \"piv\"\n");
  EXPECT_EQ(particle_count(cameras[0].loaded.setup), particle_count(cameras[1].loaded.setup));
  for (CameraCase const& one : cameras) {
    expect_consistent(one.loaded);
    EXPECT_EQ(one.loaded.setup.piv->particles.count, ParticleCount::number);
    EXPECT_THAT(one.loaded.document.resolved(), Not(HasSubstr("per_pixel")));
  }
}

// The problems of all cameras are reported together, at the lines of the file.
TEST(LoadedCameras, ReportTheProblemsOfAll) {
  std::string text = two_cameras("");
  for (char const* const pixels : {"[64, 64]", "[96, 64]"}) text.replace(text.find(pixels), 8, "[-1, -1]");
  EXPECT_EQ(error_of([&] { load_cameras(SetupDocument::from_text(text, "setup.toml")); }),
            "out_of_range at setup.toml:4:1, out_of_range at setup.toml:8:1");
}

}  // namespace
}  // namespace gladstone
