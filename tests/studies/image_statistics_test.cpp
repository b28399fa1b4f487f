#include "studies/case/image_statistics.h"

#include <gtest/gtest.h>

#include <random>

namespace gladstone {
namespace {

/// Gaussian dots with an e^-2 diameter of 3 px and a height of 1000 on a level of 200, about 11 px apart with random
/// phases, and white noise.
Image<double> dots(double height, double noise) {
  constexpr int size = 192;
  std::mt19937_64 engine(5);
  std::uniform_real_distribution<double> phase(-2.0, 2.0);
  std::normal_distribution<double> normal;
  Image<double> image(size, size, 200.0);
  for (int y = 6; y < size; y += 11) {
    for (int x = 6; x < size; x += 11) {
      double const cx = x + phase(engine), cy = y + phase(engine);
      for (int row = std::max(0, y - 8); row < std::min(size, y + 9); ++row) {
        for (int column = std::max(0, x - 8); column < std::min(size, x + 9); ++column) {
          double const r2 = (column - cx) * (column - cx) + (row - cy) * (row - cy);
          image(column, row) += height * std::exp(-8 * r2 / 9);
        }
      }
    }
  }
  for (double& value : image) value += noise * normal(engine);
  return image;
}

// Peaks are sampled up to half a pixel from their maximum: at the median r^2 of 0.16, exp(-8 r^2 / 9) is 0.87 of the
// height. The noise is estimated from 7200 pixels, correlated over 9: 2.5 %; its contribution to the peaks, the largest
// of a few values, is up to 2 sigma.
TEST(ImageStatistics, FindsHeightNoiseAndDiameterOfDots) {
  for (double const height : {1000.0, -180.0}) {
    for (double const noise : {5.0, 20.0}) {
      ImageStatistics const seen = image_statistics(dots(height, noise));
      EXPECT_NEAR(seen.noise, noise, 0.08 * noise) << height;
      EXPECT_NEAR(seen.background, 200, 0.7 * noise) << height;
      EXPECT_NEAR(seen.dot_height, 0.87 * std::abs(height), 0.04 * std::abs(height) + 2 * noise) << noise;
      EXPECT_DOUBLE_EQ(seen.snr(), seen.dot_height / seen.noise);
      EXPECT_NEAR(seen.dot_diameter_px, 3, 0.15) << height << ' ' << noise;
    }
  }
}

// One pixel in fifty is missing: the estimates from the others change by less than their own scatter, 2.5 % of the
// noise.
TEST(ImageStatistics, LeavesOutPixelsThatAreNoNumbers) {
  Image<double> image = dots(1000.0, 10.0);
  ImageStatistics const whole = image_statistics(image);
  for (std::size_t i = 7; i < image.size(); i += 50) image.data()[i] = i % 100 < 50 ? std::nan("") : HUGE_VAL;
  ImageStatistics const seen = image_statistics(image);
  EXPECT_NEAR(seen.mean, whole.mean, 0.02 * whole.mean);
  EXPECT_NEAR(seen.noise, whole.noise, 0.05 * whole.noise);
  EXPECT_NEAR(seen.dot_height, whole.dot_height, 0.05 * whole.dot_height);
  EXPECT_NEAR(seen.dot_diameter_px, whole.dot_diameter_px, 0.05);
}

TEST(ImageStatistics, SnrIsUndefinedWithoutNoiseOrDots) {
  Image<double> black(64, 64, 0.0);
  EXPECT_TRUE(std::isnan(image_statistics(black).snr()));
  for (int row : {12, 40}) black(30, row) = 100;
  EXPECT_EQ(image_statistics(black).noise, 0);
  EXPECT_EQ(image_statistics(black).dot_height, 100);
  EXPECT_TRUE(std::isnan(image_statistics(black).snr()));
  EXPECT_TRUE(std::isnan(image_statistics(Image<double>(2, 2, 7.0)).noise));
}

}  // namespace
}  // namespace gladstone
