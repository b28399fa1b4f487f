#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

// f_number = inf: each point of the dot sends one ray through the pupil's centre, which is never clipped. In a uniform
// gradient, this ray is deflected like any other, and its displacement is Eq. 9 with the lever of each slice, within
// theta^2 = (2.6 mm/1 m)^2 = 7e-6 at 30 px off the axis, and within the field's own n - n0 there, K g 1.9 mm = 2.1e-5.
TEST(ChiefRays, TruthIsTheChiefRaysDisplacement) {
  auto setup = table1_setup(128);
  setup.lens.f_number = std::numeric_limits<double>::infinity();
  setup.medium.field = uniform_gradient(50, -20);
  PlannedScene scene = scene_with_dots(setup, {{63.5, 63.5}, {33.5, 63.5}}, 100);
  ASSERT_TRUE(scene.chief_rays_only());
  Rendering const rendering = render_all(scene);
  auto const vignetted = static_cast<std::size_t>(RayStatus::vignetted);
  EXPECT_EQ(rendering.statuses[0][vignetted] + rendering.statuses[1][vignetted], 0);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ(rendering.truth.rays[i][0], 100);
    EXPECT_EQ(rendering.truth.rays[i][1], 100);
    EXPECT_NEAR(rendering.truth.displacement_px[i].x, rendering.truth.chief_px[i].x, 4e-5 * 0.33);
    EXPECT_NEAR(rendering.truth.displacement_px[i].y, rendering.truth.chief_px[i].y, 4e-5 * 0.33);
    EXPECT_NEAR(rendering.truth.chief_px[i].x, rendering.truth.eq9_px[i].x, 1e-9);
  }
  // without diffraction, the light of a ray stays in one pixel: a dot of 3 px covers at most five pixels in each
  // direction
  int lit = 0;
  for (double const light : rendering.light.reference) lit += light > 0;
  EXPECT_LE(lit, 2 * 25);
  EXPECT_GE(lit, 2 * 7);
}

// A chief ray of a point has no cone, so that a sinusoid has the full amplitude of Eq. 9 (62 % of it at f/11).
TEST(ChiefRays, DoNotAverage) {
  auto setup = table1_setup(64);
  setup.lens.f_number = std::numeric_limits<double>::infinity();
  setup.target.dot_diameter_px = 0;
  setup.medium.field = Sinusoid<double>::wave(1e-3, 4e-3);
  PlannedScene scene = scene_with_dots(setup, {{31.5, 31.5}}, 1);
  GroundTruth const truth = trace_truth(scene);
  EXPECT_NEAR(truth.displacement_px[0].x / truth.eq9_px[0].x, 1, 1e-4);
  EXPECT_NEAR(truth.displacement_std_px[0].x, 0, 1e-8);  // square root of the rounding errors of squares
}

// If the camera is focused on the medium, the dots are blurred into discs of diameter d_A |1 - z_i/z_i'| about their
// chief rays, which land at M = z_i/Z_B: 9.5455 mm times 4.070 % = 38.84 px, with a standard deviation of a quarter of
// it. cos^4 over the pupil moves the centroid by 4 theta r^2/(4 R) of the blur, below 1e-3 px; a net of 2^12 points
// determines the mean to 38.8 px/2^10.
TEST(Defocus, BlursByThePupilAndKeepsTheMagnification) {
  auto setup = table1_setup(256);
  setup.lens.focus = Focus::medium;
  setup.target.dot_diameter_px = 0;
  auto const at = lattice(256, 3, 80);
  PlannedScene scene = scene_with_dots(setup, at, 1 << 14);
  double const sensor = 0.105 * 0.75 / (0.75 - 0.105), sharp = 0.105 / 0.895;
  EXPECT_NEAR(scene.imaging.magnification, sensor, 1e-15);
  double const diameter = 0.105 / 11 * (sensor / sharp - 1) / 10e-6;
  EXPECT_NEAR(diameter, 38.84, 0.01);
  GroundTruth const truth = trace_truth(scene);
  for (std::size_t i = 0; i < at.size(); ++i) {
    EXPECT_NEAR(truth.reference_px[i].x, at[i].x, 0.04);
    EXPECT_NEAR(truth.reference_px[i].y, at[i].y, 0.04);
    EXPECT_NEAR(truth.displacement_std_px[i].x, diameter / 4, 0.02);
    EXPECT_NEAR(truth.displacement_std_px[i].y, diameter / 4, 0.02);
  }
}

// In the image, there is no light beyond the blur disc plus the PSF, and the light inside is uniform: total light over
// the disc's area.
TEST(Defocus, SpreadsTheDotsLightOverTheBlurDisc) {
  auto setup = table1_setup(96);
  setup.lens.focus = Focus::medium;
  setup.target.dot_diameter_px = 0;
  PlannedScene scene = scene_with_dots(setup, {{47.5, 47.5}}, 1 << 14);
  Rendering const rendering = render_all(scene);
  double const radius = 38.84 / 2, even = 1 / (3.14159265 * radius * radius);
  double inside = 0;
  int pixels = 0;
  for (int row = 0; row < 96; ++row) {
    for (int column = 0; column < 96; ++column) {
      double const r = std::hypot(column - 47.5, row - 47.5);
      if (r > radius + 3) {
        ASSERT_LT(rendering.light.reference(column, row), 1e-6);
      }
      if (r < radius - 3) inside += rendering.light.reference(column, row), ++pixels;
    }
  }
  EXPECT_NEAR(inside / pixels / even, 1, 0.02);
}

// A defocused camera displaces dots by M Z_D with its own M; the medium deflects the same rays.
TEST(Defocus, DisplacementFollowsTheActualMagnification) {
  auto setup = table1_setup(96);
  setup.lens.focus = Focus::medium;
  setup.medium.field = uniform_gradient(100, 0);
  PlannedScene scene = scene_with_dots(setup, {{47.5, 47.5}}, 1 << 15);
  GroundTruth const truth = trace_truth(scene);
  double const M = 0.105 * 0.75 / (0.75 - 0.105), n0 = 1 + 2.26e-4 * 1.225;
  EXPECT_NEAR(truth.eq9_px[0].x, -M * 0.25 * 2.26e-4 * 0.01 * 100 / n0 / 10e-6, 1e-9);
  // the clipped pupil remains centred: the bundle has the displacement of its chief ray
  EXPECT_NEAR(truth.displacement_px[0].x, truth.eq9_px[0].x, 0.02);
}

}  // namespace
}  // namespace gladstone
