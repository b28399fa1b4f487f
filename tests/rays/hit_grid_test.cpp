#include "render/rays/hit_grid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/base/random.h"
#include "render/scene/light_patch.h"

namespace gladstone {
namespace {

/// Light of the same hits, accumulated on a grid and as individual PSFs.
struct Both {
  Image<double> grid, spots;
};

Both accumulate_light(double sigma, std::vector<Vec2d> const& hits, int side = 40) {
  SpotView spot;
  spot.model = SpotModel::gaussian;
  spot.gaussian.sigma = sigma;
  LightImage gathered(side, side), laid(side, side);
  HitGrid grid(spot.gaussian);
  LightPatch patch(spot);
  double const share = 1.0 / static_cast<double>(hits.size());
  for (Vec2d const p : hits) {
    grid.deposit(p, 1, &gathered, share);
    patch.deposit(p, 1, &laid, share);
  }
  grid.flush(&gathered, share);
  patch.flush(&laid, share);
  return {gathered.to_light(), laid.to_light()};
}

double largest_difference(Both const& both) {
  double largest = 0;
  for (std::size_t i = 0; i < both.grid.size(); ++i) {
    largest = std::max(largest, std::abs(both.grid.data()[i] - both.spots.data()[i]));
  }
  return largest;
}

// A single hit is the worst case: the error of the spline is h^4 / 384 of the fourth derivative of a pixel's light,
// which is at most 1.38 / sigma^4 for a pixel much wider than the PSF, whose two edges do not compensate: 4.5e-5 with
// three nodes per sigma.
TEST(HitGrid, LaysASingleRaysSpotDownToAFifthOfALevelOfTwelveBits) {
  for (double const sigma : {0.15, 0.275, 0.5, 0.9, 2.0}) {
    for (Vec2d const at : {Vec2d{20, 20}, {20.5, 20.5}, {19.53, 20.31}, {20.017, 19.999}}) {
      EXPECT_LT(largest_difference(accumulate_light(sigma, {at})), 5e-5) << sigma;
    }
  }
}

// For rays spread over a dot's image, the errors have either sign and cancel.
TEST(HitGrid, LaysADotDownToATenthOfALevel) {
  std::vector<Vec2d> hits;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    double const r = 1.5 * std::sqrt(to_unit(random_bits(1, RandomStream::pupil, i, 0)));
    double const turn = 6.283185307179586 * to_unit(random_bits(1, RandomStream::pupil, i, 1));
    hits.push_back({19.3 + r * std::cos(turn), 20.8 + r * std::sin(turn)});
  }
  // relative to the brightest pixel, which has 0.14 of all light
  EXPECT_LT(largest_difference(accumulate_light(0.275, hits)), 2.4e-5 * 0.14);
}

// Hits that exceed the capacity of the grid, are outside the image, or are invalid: all light is conserved.
TEST(HitGrid, MovesOnWhereRaysSpread) {
  Both const both =
      accumulate_light(0.4, {{3, 4}, {35, 33}, {3.2, 30}, {20, 20}, {-300, 5}, {1e300, 4}, {std::nan(""), 2}});
  EXPECT_LT(largest_difference(both), 5e-5 / 7);
  double sum = 0;
  for (double const light : both.grid) sum += light;
  EXPECT_NEAR(sum, 4.0 / 7, 1e-6);
}

// Images wider than all tiles together: tiles are reused for other positions.
TEST(HitGrid, LaysWideDotsDownInTiles) {
  for (double const radius : {14.0, 80.0, 140.0}) {
    std::vector<Vec2d> hits;
    for (std::uint64_t i = 0; i < 20000; ++i) {
      double const r = radius * std::sqrt(to_unit(random_bits(1, RandomStream::pupil, i, 0)));
      double const turn = 6.283185307179586 * to_unit(random_bits(1, RandomStream::pupil, i, 1));
      hits.push_back({150 + r * std::cos(turn), 150 + r * std::sin(turn)});
    }
    Both const both = accumulate_light(0.5, hits, 300);
    // at most 5e-5 of each ray that illuminates a pixel: those of the nine pixels around it
    EXPECT_LT(largest_difference(both), 5e-5 * 9 / (3.14 * radius * radius)) << radius;
    double sum = 0;
    for (double const light : both.grid) sum += light;
    EXPECT_NEAR(sum, 1, 1e-9);
  }
}

}  // namespace
}  // namespace gladstone
