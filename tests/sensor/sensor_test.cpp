#include <gtest/gtest.h>

#include <cmath>

#include "render/sensor/exposure.h"
#include "render/sensor/posed_sensor.h"

namespace gladstone {
namespace {

PosedSensor<double> const sensor{{}, 10e-6, 640, 480, {}};

// Pixel centres are at integers from 0, so that the centre of 640 x 480 pixels is at (319.5, 239.5).
TEST(Sensor, AxisHitsTheMiddleOfThePixels) { EXPECT_EQ(sensor.to_pixel(0, 0), (Vec2d{319.5, 239.5})); }

// The lens images the right of the scene (+X) to the left of the sensor (-x) and the top (+Y) to the bottom (-y). In
// the stored image, right is a larger column and up a smaller row.
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

// The unit is 2^-44: half a unit is rounded away from zero and less than half to zero, for both signs.
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
  EXPECT_EQ(to_fixed_point(5e5), static_cast<std::int64_t>(5e5) << 44);  // largest value that fits
}

}  // namespace
}  // namespace gladstone
