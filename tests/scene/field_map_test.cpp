#include "render/scene/field_map.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/units.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {
namespace {

// Averages along the chief ray: density ambient + g . x at the intersection X_A = X Z_A/Z_B with the mid-plane,
// gradient g, and displacement by Eq. 9.
TEST(FieldMap, ShowsAUniformGradientAsItIs) {
  auto setup = table1_setup(128);
  setup.medium.field = uniform_gradient(20, -5);
  PlannedScene const scene = scene_with_dots(setup, {{64, 64}}, 1);
  FieldMap const map = map_field(scene, scene.plan.step, 16);
  ASSERT_EQ(map.density.columns(), 8);
  for (int row = 0; row < 8; ++row) {
    for (int column = 0; column < 8; ++column) {
      Vec2d const px = map.position_px(column, row);
      EXPECT_EQ(px.x, 16 * column + 7.5);
      Vec2d const at_medium = 0.75 * scene.to_target(px);
      EXPECT_NEAR(map.density(column, row), 1.225 + 20 * at_medium.x - 5 * at_medium.y, 1e-9);
      EXPECT_NEAR(map.density_gradient(column, row).x, 20, 1e-9);
      EXPECT_NEAR(map.density_gradient(column, row).y, -5, 1e-9);
      EXPECT_NEAR(map.eq9_px(column, row).x, -20 * 0.006626657, 1e-7);
      EXPECT_NEAR(map.eq9_px(column, row).y, -5 * 0.006626657, 1e-7);
    }
  }
}

TEST(FieldMap, IsAmbientWithoutAField) {
  PlannedScene const scene = scene_with_dots(table1_setup(32), {{16, 16}}, 1);
  FieldMap const map = map_field(scene, scene.plan.step, 8);
  EXPECT_EQ(map.density(1, 1), 1.225);
  EXPECT_EQ(map.density_gradient(1, 1), (Vec2d{0, 0}));
}

// A uniform displacement has no strain. The pupil points of different lattice points differ by their scrambling, but
// the gradient is the same at all of them.
TEST(StrainMap, OfAUniformGradientIsZero) {
  auto setup = table1_setup(256);
  setup.medium.field = uniform_gradient(100, 50);
  StrainMap const map = map_strain(scene_with_dots(setup, {{64, 64}}, 1));
  for (double const strain : map.strain) ASSERT_NEAR(strain, 0, 1e-6);
  EXPECT_EQ(map.caustic_fraction, 0);
}

// For rho = A sin(k x), du/dx in the image is (Z_A Z_D/Z_B) K L_z/n0 A k^2 H sin(k X_A), with H = 0.894131 at 8 mm.
// Central differences over 2 h reduce it by sin(k h)/(k h); h = 4 px are 0.256 mm in the medium, k h = 0.2.
TEST(StrainMap, OfASinusoidHasItsKnownAmplitude) {
  auto setup = table1_setup(512);
  setup.medium.field = sinusoid(0.02, 8e-3);
  PlannedScene const scene = scene_with_dots(setup, {{64, 64}}, 1);
  StrainMap const map = map_strain(scene);
  double const k = 2 * pi / 8e-3, n0 = 1 + 2.26e-4 * 1.225;
  double const h = map.spacing_px * 10e-6 / scene.imaging.magnification * 0.75;
  double const amplitude = 0.75 * 0.25 * 2.26e-4 * 0.01 / n0 * 0.02 * k * k * 0.894131 * std::sin(k * h) / (k * h);
  // the distance of the lattice from the crests is at most half a spacing, 1 - (k h/2)^2/2; 64 points of a net average
  // to one percent
  EXPECT_NEAR(*std::max_element(map.strain.begin(), map.strain.end()) / amplitude, 1, 0.03);
  EXPECT_NEAR(*std::max_element(map.caustic.begin(), map.caustic.end()) / amplitude, 1, 0.03);
  EXPECT_EQ(map.caustic_fraction, 0);
}

// F19: rays cross only where they converge, that is, where du/dx >= 1 in the image. With an amplitude of 3, this is the
// case in acos(1/3)/pi = 39 % of the view, within 0.03 for the lattice and one percent for the net.
TEST(StrainMap, FindsCausticsWhereRaysConverge) {
  auto setup = table1_setup(512);
  double const k = 2 * pi / 16e-3;
  // H at 16 mm: 1 - v^2/8 + v^4/192 with v = pi 2.386/16
  double const v = pi * 2.386364 / 16, kept = 1 - v * v / 8 + std::pow(v, 4) / 192;
  setup.medium.field = sinusoid(3 / (0.75 * 0.25 * 2.26e-4 * 0.01 * k * k * kept), 16e-3, {0, 1});
  StrainMap const map = map_strain(scene_with_dots(setup, {{64, 64}}, 1));
  EXPECT_NEAR(*std::max_element(map.caustic.begin(), map.caustic.end()), 3, 0.1);
  // 32.7 mm are 2.04 periods; the part beyond two periods changes the fraction by up to 2 %
  EXPECT_NEAR(map.caustic_fraction, std::acos(1.0 / 3) / pi, 0.04);
}

// Averaged over the light cone (2.4 mm), the strain of the fronts in the early DNS plane, which are a few cells of
// 0.0625 mm wide, is small. Without averaging, rays cross, as chief rays alone (f_number = inf: no cone) show. The late
// plane has no such fronts.
TEST(StrainMap, ConeAveragingHidesTheCausticsOfTheEarlierDnsPlane) {
  double largest[2], without_cone[2];
  int i = 0;
  for (char const* instant : {"kepeak", "late"}) {
    auto setup = table1_setup(512);
    setup.medium.field = dns_plane(instant);
    StrainMap const averaged = map_strain(scene_with_dots(setup, {{64, 64}}, 1));
    largest[i] = *std::max_element(averaged.strain.begin(), averaged.strain.end());
    EXPECT_EQ(averaged.caustic_fraction, 0) << instant;
    setup.lens.f_number = std::numeric_limits<double>::infinity();
    without_cone[i++] = map_strain(scene_with_dots(setup, {{64, 64}}, 1)).caustic_fraction;
  }
  EXPECT_LT(largest[0], 0.3);
  EXPECT_GT(largest[0], 2 * largest[1]);
  EXPECT_GT(without_cone[0], 1e-3);
  EXPECT_LT(without_cone[1], 1e-3);
}

}  // namespace
}  // namespace gladstone
