#include "render/sensor/sensor.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/sensor/exposure.h"

namespace gladstone {
namespace {

Sensor<double> const sensor{0.867, 10e-6, 640, 480};

// Pixel centres are whole numbers from 0, so the middle of 640 x 480 is (319.5, 239.5).
TEST(Sensor, AxisHitsTheMiddleOfThePixels) { EXPECT_EQ(sensor.to_pixel(0, 0), (Vec2d{319.5, 239.5})); }

// A lens throws scene right (+X) on the left of its sensor (-x) and scene up (+Y) below (-y); in the picture right is a
// larger column and up a smaller row.
TEST(Sensor, PictureIsNotInverted) {
  Vec2d const scene_right = sensor.to_pixel(-50e-6, 0), scene_up = sensor.to_pixel(0, -50e-6);
  EXPECT_NEAR(scene_right.x, 324.5, 1e-12);
  EXPECT_EQ(scene_right.y, 239.5);
  EXPECT_EQ(scene_up.x, 319.5);
  EXPECT_NEAR(scene_up.y, 234.5, 1e-12);
}

TEST(Sensor, CoversHalfAPixelAroundTheOuterCentres) {
  EXPECT_TRUE(sensor.covers({-0.5, -0.5}));
  EXPECT_TRUE(sensor.covers({639.4999, 479.4999}));
  EXPECT_FALSE(sensor.covers({-0.5001, 0}));
  EXPECT_FALSE(sensor.covers({639.5, 0}));
  EXPECT_FALSE(sensor.covers({0, 479.5}));
  EXPECT_FALSE(sensor.covers({std::nan(""), 0}));
}

// Units of 2^-44: half a unit rounds away from zero, less than half to zero, both signs alike.
TEST(FixedPoint, RoundsToTheNearestUnit) {
  double const unit = 0x1p-44;
  EXPECT_EQ(to_fixed_point(1.0), std::int64_t{1} << 44);
  EXPECT_EQ(to_fixed_point(0.0), 0);
  EXPECT_EQ(to_fixed_point(0.49 * unit), 0);
  EXPECT_EQ(to_fixed_point(0.5 * unit), 1);
  EXPECT_EQ(to_fixed_point(7.49 * unit), 7);
  EXPECT_EQ(to_fixed_point(-0.49 * unit), 0);
  EXPECT_EQ(to_fixed_point(-0.5 * unit), -1);
  EXPECT_EQ(to_fixed_point(-7.51 * unit), -8);
  EXPECT_EQ(to_fixed_point(5e5), static_cast<std::int64_t>(5e5) << 44);  // the brightest that fits
}

}  // namespace
}  // namespace gladstone
