#include "studies/compare/map_refinement.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <set>

#include "render/base/units.h"

namespace gladstone {
namespace {

/// Map of a function of the pixel, with the number of pixels at which it was computed.
struct CountedMap {
  Image<Vec2d> map;
  std::size_t computed = 0;
};

template <class Function>
CountedMap refine(int columns, int rows, int coarsest, Function const& value, double error = 0) {
  CountedMap counted;
  std::set<std::pair<int, int>> once;
  counted.map = refine_map(columns, rows, coarsest, [&](std::vector<MapNode> const& nodes) {
    MapSamples samples;
    for (MapNode const& node : nodes) {
      EXPECT_TRUE(once.insert({node.column, node.row}).second) << "computed twice";
      samples.value.push_back(value(node.column, node.row));
      samples.error.push_back({error, error});
    }
    return samples;
  });
  counted.computed = once.size();
  return counted;
}

template <class Function>
double largest_deviation(Image<Vec2d> const& map, Function const& value) {
  double largest = 0;
  for (int row = 0; row < map.rows(); ++row)
    for (int column = 0; column < map.columns(); ++column) {
      Vec2d const deviation = map(column, row) - value(column, row);
      largest = std::max({largest, std::abs(deviation.x), std::abs(deviation.y)});
    }
  return largest;
}

// Cubic interpolation reproduces products of cubics to rounding, from every fourth column and row.
TEST(MapRefinement, OfACubicNeedsEveryFourthPixel) {
  auto const cubic = [](double x, double y) { return Vec2d{1e-5 * x * x * x - 1e-3 * x * y, 0.3 - 1e-5 * y * y * y}; };
  CountedMap const found = refine(65, 33, 8, cubic);
  EXPECT_EQ(found.computed, 17u * 9u);
  EXPECT_LT(largest_deviation(found.map, cubic), 1e-10);
}

// The error of interpolation over h of sin(k x) is at most 9/384 (h k)^4: below the tolerance of 5e-4 px at h = 8 px
// where the amplitude is 1 px and the wavelength longer than 2 pi 8 (9 / 384 / 5e-4)^(1/4) = 131 px. Interpolation is
// over at most half of the distance at which this is found, with a 16 times smaller error: both axes (2) and one-sided
// stencils at the border (5/3) make that up to 3.3 / 16 of the tolerance.
TEST(MapRefinement, ErrorsOfSmoothMapsAreBelowTheTolerance) {
  for (double const wavelength : {400.0, 140.0, 100.0, 40.0, 17.0}) {
    double const k = 2 * pi / wavelength;
    auto const wave = [k](double x, double y) { return Vec2d{std::sin(k * x), std::cos(k * (y - 0.3 * x))}; };
    CountedMap const found = refine(128, 128, 8, wave);
    EXPECT_LT(largest_deviation(found.map, wave), refinement_tolerance / 4) << wavelength;
    EXPECT_EQ(found.computed == 33u * 33u, wavelength == 400.0) << wavelength;
  }
}

// A step is computed pixel by pixel, and nothing far from it.
TEST(MapRefinement, StepsAreComputedAtEveryPixel) {
  auto const step = [](int x, int) { return Vec2d{x < 61 ? 0.0 : 1.0, 0.0}; };
  CountedMap const found = refine(128, 64, 8, step);
  EXPECT_LT(largest_deviation(found.map, step), refinement_tolerance);
  EXPECT_LT(found.computed, 128u * 64u / 2);
}

// Deviations that noise explains do not refine the map.
TEST(MapRefinement, ScatterOfTheValuesIsTolerated) {
  auto const noisy = [](int x, int y) { return Vec2d{1e-3 * std::sin(1e4 * x + 1e6 * y), 0.0}; };
  EXPECT_EQ(refine(65, 65, 8, noisy, 1e-3).computed, 17u * 17u);
  EXPECT_GT(refine(65, 65, 8, noisy).computed, 500u) << "without a known error";
}

TEST(MapRefinement, BordersOfUnknownValuesAreExact) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  auto const disc = [](int x, int y) {
    return std::hypot(x - 40.3, y - 30.1) < 21.7 ? Vec2d{1e-3 * x, 2e-3 * y} : Vec2d{nan, nan};
  };
  CountedMap const found = refine(90, 70, 8, disc);
  for (int row = 0; row < 70; ++row)
    for (int column = 0; column < 90; ++column) {
      bool const known = std::isfinite(disc(column, row).x);
      ASSERT_EQ(std::isfinite(found.map(column, row).x), known) << column << ' ' << row;
      if (known) {
        ASSERT_NEAR(found.map(column, row).y, 2e-3 * row, 1e-12);
      }
    }
}

TEST(MapRefinement, SmallMapsAreComputed) {
  auto const value = [](int x, int y) { return Vec2d{1.0 * x * x, 2.0 * y}; };
  for (int const coarsest : {1, 2, 8}) {
    EXPECT_LT(largest_deviation(refine(1, 1, coarsest, value).map, value), 1e-12);
    EXPECT_LT(largest_deviation(refine(3, 2, coarsest, value).map, value), 1e-9);
  }
}

}  // namespace
}  // namespace gladstone
