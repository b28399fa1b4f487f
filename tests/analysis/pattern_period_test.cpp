#include "analysis/correlation/pattern_period.h"

#include <gtest/gtest.h>

#include <random>

#include "studies/benchmark/particle_pair.h"

namespace gladstone {
namespace {

Image<double> picture_of_dots(ParticleSettings const& settings) {
  return render_particle_pair(settings, [](Vec2d) { return Vec2d{}; }).reference;
}

/// Independent random grey levels.
Image<double> picture_of_noise(int columns, int rows) {
  Image<double> image(columns, rows, 0.0);
  std::mt19937 bits(5);
  for (double& value : image) value = static_cast<double>(bits() % 256);
  return image;
}

// The decrease of the plane towards its edge biases its peaks by some hundredths of a pixel towards zero.
TEST(PatternPeriod, IsThePitchOfRegularDots) {
  for (double const pitch : {6.0, 7.155, 10.3, 25.0})
    for (double const noise : {0.0, 0.05}) {
      auto const period = pattern_period(picture_of_dots({.noise = noise, .pitch_px = pitch}), {});
      ASSERT_TRUE(period) << pitch << ' ' << noise;
      EXPECT_NEAR(period->pitch_px, pitch, 0.06);
      EXPECT_NEAR(period->height, 1.0, 0.1);
    }
}

// Points of one pixel correlate with themselves at whole pitches only, and not one pixel away from them.
TEST(PatternPeriod, IsThePitchOfPointsOfOnePixel) {
  Image<double> points(256, 256, 10.0);
  for (int j = 3; j < 256; j += 8)
    for (int i = 3; i < 256; i += 8) points(i, j) = 200.0;
  auto const period = pattern_period(points, {});
  ASSERT_TRUE(period);
  EXPECT_NEAR(period->pitch_px, 8.0, 0.01);
}

TEST(PatternPeriod, IsNoneInDotsAtRandomInNoiseAndInNothing) {
  for (double const particles : {4.0, 20.0, 40.0})
    for (double const noise : {0.0, 0.05, 0.4})
      for (std::uint64_t const seed : {1, 2})
        EXPECT_FALSE(
            pattern_period(picture_of_dots({.particles_per_px = particles / 1024.0, .noise = noise, .seed = seed}), {}))
            << particles << ' ' << noise << ' ' << seed;
  EXPECT_FALSE(pattern_period(picture_of_noise(200, 200), {}));
  EXPECT_FALSE(pattern_period(picture_of_noise(64, 64), {}));
  EXPECT_FALSE(pattern_period(Image<double>(128, 128, 100.0), {}));
}

// A shift by twice the search radius leads from one end of the range to the other: longer periods cannot cause an
// ambiguity. The search radius of the first pass is half a window, or max_displacement_px rounded up to a multiple of 4
// px.
TEST(PatternPeriod, IsNoneBeyondTwoSearchRanges) {
  Image<double> const image = picture_of_dots({.pitch_px = 12.0});
  CorrelationSettings settings;
  settings.window_px = {16};
  EXPECT_TRUE(pattern_period(image, settings));
  settings.window_px = {10};
  EXPECT_FALSE(pattern_period(image, settings));
  settings.window_px = {64, 32};
  EXPECT_TRUE(pattern_period(image, settings));
  settings.max_displacement_px = 4.0;
  EXPECT_FALSE(pattern_period(image, settings));
}

}  // namespace
}  // namespace gladstone
