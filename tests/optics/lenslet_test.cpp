#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "render/base/error.h"
#include "render/optics/camera_element.h"
#include "render/optics/elements/lenslets.h"
#include "render/optics/ray_bundle.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

constexpr double pitch_m = 125e-6, focal_m = 500e-6;

LensletArray<double> array_of(LensletLayout layout) {
  return {Pose<double>{{0.001, -0.002, 0.05}}.turned({0.1, -0.2, 0.3}), pitch_m, focal_m, layout};
}

/// Returns the axes of a layout, from its definition.
Vec2d axis_of(LensletLayout layout, int column, int row) {
  if (layout == LensletLayout::square) return {column * pitch_m, row * pitch_m};
  return {(column + (row % 2 != 0 ? 0.5 : 0.0)) * pitch_m, row * pitch_m * std::sqrt(0.75)};
}

// A point belongs to the lenslet with the nearest axis, compared with a search over all axes.
TEST(LensletArray, AxisIsTheNearestOfItsLayout) {
  for (LensletLayout const layout : {LensletLayout::square, LensletLayout::hexagonal}) {
    LensletArray<double> const array = array_of(layout);
    for (int k = 0; k < 2000; ++k) {
      Vec2d const place = 5 * pitch_m * sunflower(k, 2000);
      Vec2d nearest{1, 1};
      for (int column = -8; column <= 8; ++column) {
        for (int row = -8; row <= 8; ++row) {
          Vec2d const axis = axis_of(layout, column, row);
          if (length(axis - place) < length(nearest - place)) nearest = axis;
        }
      }
      EXPECT_NEAR(length(array.axis_at(place) - nearest), 0, 1e-15) << k;
    }
  }
}

// A plane wave of slope s is focused at f s from the axis of every lenslet: the foci are one pitch apart, at any pose
// of the array.
TEST(LensletArray, ImagesAPlaneWaveIntoSpotsAtItsPitch) {
  for (LensletLayout const layout : {LensletLayout::square, LensletLayout::hexagonal}) {
    LensletArray<double> const array = array_of(layout);
    for (Vec2d const slope : {Vec2d{0, 0}, {0.05, -0.08}}) {
      for (int k = 0; k < 500; ++k) {
        Vec2d const at = 4 * pitch_m * sunflower(k, 500);
        Vec3d const direction = normalized(Vec3d{slope.x, slope.y, 1});
        Ray<double> ray = array.pose.outwards(Ray<double>{Vec3d{at.x, at.y, 0} - 0.01 * direction, direction});
        RayAccount<double> account;
        ASSERT_EQ(array.interact(ray, account), RayStatus::alive);
        Ray<double> const local = array.pose.inwards(ray);
        Vec2d const spot{local.position.x + focal_m * local.direction.x / local.direction.z,
                         local.position.y + focal_m * local.direction.y / local.direction.z};
        EXPECT_NEAR(length(spot - array.axis_at(at) - focal_m * slope), 0, 1e-16 * 100) << k;
        EXPECT_EQ(account.weight, 1);  // no light is lost between the lenslets
      }
    }
  }
}

// Rays parallel to the plane or from behind are not deflected.
TEST(LensletArray, IsMissedFromBehind) {
  LensletArray<double> const array{{}, pitch_m, focal_m, LensletLayout::square};
  Ray<double> ray{{0, 0, 1}, {0, 0, -1}};
  RayAccount<double> account;
  EXPECT_EQ(array.interact(ray, account), RayStatus::missed_lens);
}

LensletSetup lenslets_of(std::string const& text) {
  SetupDocument document = SetupDocument::from_text(text, "case.toml");
  SetupTable table = document.root().table("lenslets");
  LensletSetup const setup = LensletSetup::read(table);
  document.finish();
  return setup;
}

// f = R / (n - 1) of a plano-convex lens; the sensor is in the focal plane by default.
TEST(LensletSetup, ReadsEveryKey) {
  auto const plain = lenslets_of("[lenslets]\npitch_um = 125\nfocal_length_um = 500\n");
  EXPECT_NEAR(plain.pitch, 125e-6, 1e-18);
  EXPECT_NEAR(plain.to_sensor, 500e-6, 1e-18);
  EXPECT_EQ(plain.layout, LensletLayout::square);
  auto const ground = lenslets_of(
      "[lenslets]\npitch_um = 100\nradius_um = 230\nindex = 1.46\ndistance_um = 450\nlayout = \"hexagonal\"\n");
  EXPECT_NEAR(ground.focal_length, 500e-6, 1e-15);
  EXPECT_NEAR(ground.to_sensor, 450e-6, 1e-18);
  EXPECT_EQ(ground.layout, LensletLayout::hexagonal);
}

TEST(LensletSetup, ImpossibleOnesAreRefused) {
  EXPECT_THAT([] { lenslets_of("[lenslets]\npitch_um = 125\n"); },
              ThrowsSetupError(ErrorCode::missing_key, "lenslets.focal_length_um"));
  EXPECT_THAT([] { lenslets_of("[lenslets]\nfocal_length_um = 500\n"); },
              ThrowsSetupError(ErrorCode::missing_key, "lenslets.pitch_um"));
  EXPECT_THAT([] { lenslets_of("[lenslets]\npitch_um = 1\nfocal_length_um = 5\nradius_um = 3\nindex = 1.5\n"); },
              ThrowsSetupError(ErrorCode::invalid_value, "case.toml:3:1"));
  EXPECT_THAT([] { lenslets_of("[lenslets]\npitch_um = 1\nradius_um = 3\n"); },
              ThrowsSetupError(ErrorCode::missing_key, "lenslets.index"));
}

}  // namespace
}  // namespace gladstone
