#include "analysis/calibration/dot_detection.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "render/base/units.h"

namespace gladstone {
namespace {

/// Light of a Gaussian spot centred at `at` in pixel `i` along one axis.
double share(double at, double sigma, int i) {
  double const scale = 1 / (std::sqrt(2.0) * sigma);
  return 0.5 * (std::erf((i + 0.5 - at) * scale) - std::erf((i - 0.5 - at) * scale));
}

/// Adds a disc blurred by a Gaussian, integrated exactly over the pixels: a sum over points in opposite pairs, so that
/// its centroid is its centre, to rounding.
void add_dot(Image<double>& picture, Vec2d centre, double radius, double sigma, double level) {
  constexpr int points = 1000;  // distributed uniformly (Vogel 1979)
  for (int k = 0; k < points; ++k) {
    double const r = radius * std::sqrt((k + 0.5) / points), angle = pi * (3 - std::sqrt(5.0)) * k;
    for (double const side : {1.0, -1.0}) {
      Vec2d const at = centre + side * Vec2d{r * std::cos(angle), r * std::sin(angle)};
      int const reach = static_cast<int>(std::ceil(6 * sigma)) + 1;
      for (int row = static_cast<int>(at.y) - reach; row <= static_cast<int>(at.y) + reach; ++row) {
        for (int column = static_cast<int>(at.x) - reach; column <= static_cast<int>(at.x) + reach; ++column) {
          if (column < 0 || row < 0 || column >= picture.columns() || row >= picture.rows()) continue;
          picture(column, row) +=
              level * pi * radius * radius / (2 * points) * share(at.x, sigma, column) * share(at.y, sigma, row);
        }
      }
    }
  }
}

/// Dots at known positions, each with a different sub-pixel position.
struct Scenery {
  Image<double> picture{200, 160};
  std::vector<Vec2d> centres;

  explicit Scenery(double radius, double sigma, double level = 40000) {
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < 5; ++i) {
        centres.push_back({30 + 33.13 * i + 0.31 * j, 28 + 33.37 * j - 0.17 * i});
        add_dot(picture, centres.back(), radius, sigma, level);
      }
    }
  }
  /// Distances of the detected dots from the true ones.
  std::vector<Vec2d> errors() const {
    std::vector<Vec2d> found;
    for (DetectedDot const& dot : detect_dots(picture).dots) {
      for (Vec2d const centre : centres) {
        if (length(dot.centre_px - centre) < 2) found.push_back(dot.centre_px - centre);
      }
    }
    return found;
  }
};

// For any sub-pixel position the centroid of a dot is its centre. The sum over pixels of a band-limited image is its
// integral; a Gaussian of sigma = 0.7 px transmits exp(-2 pi^2 0.7^2) = 6e-5 at the first aliased frequency, 1/px.
TEST(DotDetection, IsUnbiasedAtAnySubpixelPosition) {
  for (double const radius : {2.0, 3.0, 6.5}) {
    Scenery const scenery(radius, 0.7);
    auto const errors = scenery.errors();
    ASSERT_EQ(errors.size(), scenery.centres.size()) << radius;
    for (Vec2d const error : errors) EXPECT_LT(length(error), 1e-4) << radius;
  }
}

TEST(DotDetection, DarkDotsOnBrightPaperAreFoundAsWell) {
  Scenery scenery(3, 0.7, -20000);
  for (double& level : scenery.picture) level += 30000;
  auto const errors = scenery.errors();
  ASSERT_EQ(errors.size(), scenery.centres.size());
  for (Vec2d const error : errors) EXPECT_LT(length(error), 1e-4);
}

// Background and noise: the error is that of the positions of the electrons, sigma_x / sqrt(N) with sigma_x^2 = r^2 / 4
// + 0.7^2 and N = pi r^2 20000 electrons, and that of 30 electrons of noise in each of the window's n pixels, whose
// squared distances from the centre sum to n R^2 / 4.
TEST(DotDetection, ErrorsAreThoseOfTheNoise) {
  constexpr double radius = 3, level = 20000, background = 500, read = 30;
  std::mt19937 random(5);
  double squares = 0;
  Vec2d sum{};
  int count = 0;
  for (int repeat = 0; repeat < 6; ++repeat) {
    Scenery scenery(radius, 0.7, level);
    for (double& value : scenery.picture) {
      double const electrons = value + background;
      value = std::round(electrons + std::normal_distribution<double>(0, std::sqrt(electrons + read * read))(random));
    }
    auto const errors = scenery.errors();
    ASSERT_EQ(errors.size(), scenery.centres.size());
    for (Vec2d const error : errors) {
      squares += dot(error, error);
      sum += error;
      ++count;
    }
  }
  double const electrons = pi * radius * radius * level, window = 1.5 * radius + 4;
  double const shot2 = (radius * radius / 4 + 0.49) / electrons;
  double const ground2 = (background + read * read) * pi * std::pow(window, 4) / 4 / (electrons * electrons);
  double const rms = std::sqrt(squares / (2 * count)), expected = std::sqrt(shot2 + ground2);
  // the rms of 240 numbers scatters by 1/sqrt(480) = 4.6 %; the window is up to a tenth wider than in the formula if
  // the threshold makes the dot appear larger, which affects the background term by its square
  EXPECT_NEAR(rms / expected, 1.0, 0.35);
  EXPECT_LT(length(sum / static_cast<double>(count)), 4 * expected / std::sqrt(static_cast<double>(count)));
}

TEST(DotDetection, ExcludesRegionsThatAreNoDots) {
  Scenery scenery(3, 0.7);
  add_dot(scenery.picture, {0.5, 80}, 3, 0.7, 40000);      // dot cut by the edge
  add_dot(scenery.picture, {100.2, 44.8}, 0.4, 0.5, 1e6);  // dust: a 25th of a dot's area, bright
  for (int column = 60; column < 140; ++column) scenery.picture(column, 150) = 30000;  // a scratch
  EXPECT_EQ(scenery.errors().size(), scenery.centres.size());
  EXPECT_EQ(detect_dots(scenery.picture).dots.size(), scenery.centres.size());
}

// The light B decreases by a quarter across the image, and is B (1 - c) in dots of contrast c. Relative to the plane P
// through the surrounding ring, a dot is c B / P + (P - B) / P. The curvature of B, 1.5e-5 / px^2, leaves terms that
// are even about the dot, and an offset of 1.5e-5 (12^2 - 6^2) = 2e-3 over the 227 px of the window, 0.4 compared with
// 23 for the dot. Each of the 53 pixels on the edge of the window shifts its centroid by 8.5/227 = 0.04 px and is
// inside or outside by chance: 0.04 sqrt(53)/2 = 0.14 px rms in length. Three times this, times 0.4/23 of the dot's
// light, is 7e-3 px. Assuming uniform light would shift the dots by 0.1 px.
TEST(DotDetection, DarkDotsUnderLightThatFallsOffAreFoundWhereTheyAre) {
  Scenery scenery(3, 0.7, -0.8);
  Image<double>& picture = scenery.picture;
  double const corner2 = 100 * 100 + 80 * 80;
  for (int row = 0; row < picture.rows(); ++row) {
    for (int column = 0; column < picture.columns(); ++column) {
      double const x = column - 99.5, y = row - 79.5, light = 3000 * (1 - 0.25 * (x * x + y * y) / corner2);
      picture(column, row) = light * (1 + picture(column, row));
    }
  }
  auto const errors = scenery.errors();
  ASSERT_EQ(errors.size(), scenery.centres.size());
  EXPECT_EQ(detect_dots(picture).dots.size(), scenery.centres.size());
  for (Vec2d const error : errors) EXPECT_LT(length(error), 7e-3);
}

// Dots so dense that their windows leave few background pixels between them, and none on the outside of the grid within
// the inner dots' rings. A quadratic polynomial through the wider surroundings follows light that varies linearly or
// with the square of the distance, so that nothing remains but the errors of the sums over pixels, 1e-4 px; where a
// plane through the ring is used, a curvature of 1.5e-5 / px^2 causes errors of up to 7e-3 px, as above. The
// interpolated medians of blocks, which the dots bias, would move dots by 0.05 px.
TEST(DotDetection, DenseDarkDotsUnderUnevenLightAreFoundWhereTheyAre) {
  Image<double> paper(200, 160);
  std::vector<Vec2d> centres;
  for (int j = -2; j <= 2; ++j) {
    for (int i = -3; i <= 3; ++i) {
      centres.push_back({99.5 + 20.38 * i, 79.5 + 20.38 * j});
      add_dot(paper, centres.back(), 3.67, 0.7, -0.95);
    }
  }
  auto const largest_error = [&](auto const& light) {
    Image<double> picture = paper;
    for (int row = 0; row < picture.rows(); ++row) {
      for (int column = 0; column < picture.columns(); ++column) {
        picture(column, row) = 2500 * light(column, row) * (1 + paper(column, row));
      }
    }
    DetectedDots const found = detect_dots(picture);
    EXPECT_EQ(found.dots.size(), centres.size());
    EXPECT_TRUE(found.not_dots.empty());
    double largest = 0;
    for (DetectedDot const& dot : found.dots) {
      double nearest = 10;
      for (Vec2d const centre : centres) nearest = std::min(nearest, length(dot.centre_px - centre));
      largest = std::max(largest, nearest);
    }
    return largest;
  };
  EXPECT_LT(largest_error([](int column, int) { return 1 - 0.5 * column / 200; }), 1e-3);
  EXPECT_LT(largest_error([](int column, int row) {
              double const x = column - 99.5, y = row - 79.5;
              return 1 - 0.25 * (x * x + y * y) / (100 * 100 + 80 * 80);
            }),
            7e-3);
}

// Letters about as large as the dots, between them: bars, rings and angles are not filled ellipses in the shape of the
// dots.
TEST(DotDetection, ExcludesAndCountsLetters) {
  Scenery scenery(3, 0.7);
  auto const fill = [&](int left, int top, int columns, int rows) {
    for (int row = top; row < top + rows; ++row) {
      for (int column = left; column < left + columns; ++column) scenery.picture(column, row) = 40000;
    }
  };
  fill(45, 38, 3, 14);  // I
  fill(78, 40, 2, 10);  // L
  fill(80, 48, 6, 2);
  fill(110, 40, 9, 2);  // O
  fill(110, 48, 9, 2);
  fill(110, 40, 2, 10);
  fill(117, 40, 2, 10);
  DetectedDots const found = detect_dots(scenery.picture);
  EXPECT_EQ(found.dots.size(), scenery.centres.size());
  EXPECT_EQ(found.not_dots.size(), 3u);
  for (Vec2d const error : scenery.errors()) EXPECT_LT(length(error), 1e-3);
}

TEST(DotDetection, FindsNoDotsInBlankImage) {
  Image<double> picture(64, 64);
  EXPECT_TRUE(detect_dots(picture).dots.empty());
  std::mt19937 random(3);
  for (double& level : picture) level = std::normal_distribution<double>(500, 20)(random);
  EXPECT_TRUE(detect_dots(picture).dots.empty());
}

}  // namespace
}  // namespace gladstone
