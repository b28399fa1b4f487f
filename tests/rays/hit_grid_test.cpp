#include "render/rays/hit_grid.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/base/random.h"
#include "render/scene/light_patch.h"

namespace gladstone {
namespace {

/// Light of hits gathered on a grid, and laid down spot by spot.
struct Both {
  Image<double> grid, spots;
};

Both lay_down(double sigma, std::vector<Vec2d> const& hits, int side = 40) {
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

// One hit is the worst case: the spline through what a pixel sees is off by h^4 / 384 of its fourth derivative, 1.38 /
// sigma^4 at most for a pixel far wider than the spot, whose edges do not help each other: 4.5e-5 with three nodes a
// sigma.
TEST(HitGrid, LaysASingleRaysSpotDownToAFifthOfALevelOfTwelveBits) {
  for (double const sigma : {0.15, 0.275, 0.5, 0.9, 2.0}) {
    for (Vec2d const at : {Vec2d{20, 20}, {20.5, 20.5}, {19.53, 20.31}, {20.017, 19.999}}) {
      EXPECT_LT(largest_difference(lay_down(sigma, {at})), 5e-5) << sigma;
    }
  }
}

// Rays spread over a dot's image: their departures have either sign and cancel.
TEST(HitGrid, LaysADotDownToATenthOfALevel) {
  std::vector<Vec2d> hits;
  for (std::uint64_t i = 0; i < 2000; ++i) {
    double const r = 1.5 * std::sqrt(to_unit(random_bits(1, RandomStream::pupil, i, 0)));
    double const turn = 6.283185307179586 * to_unit(random_bits(1, RandomStream::pupil, i, 1));
    hits.push_back({19.3 + r * std::cos(turn), 20.8 + r * std::sin(turn)});
  }
  EXPECT_LT(largest_difference(lay_down(0.275, hits)), 2.4e-5 * 0.14);  // of the brightest pixel, 0.14 of all light
}

// Hits that a grid does not hold together, beyond the picture, or nowhere, and all light is there.
TEST(HitGrid, MovesOnWhereRaysSpread) {
  Both const both = lay_down(0.4, {{3, 4}, {35, 33}, {3.2, 30}, {20, 20}, {-300, 5}, {1e300, 4}, {std::nan(""), 2}});
  EXPECT_LT(largest_difference(both), 5e-5 / 7);
  double sum = 0;
  for (double const light : both.grid) sum += light;
  EXPECT_NEAR(sum, 4.0 / 7, 1e-6);
}

// Images wider than all tiles together: some take others' places in turn.
TEST(HitGrid, LaysWideDotsDownInTiles) {
  for (double const radius : {14.0, 80.0, 140.0}) {
    std::vector<Vec2d> hits;
    for (std::uint64_t i = 0; i < 20000; ++i) {
      double const r = radius * std::sqrt(to_unit(random_bits(1, RandomStream::pupil, i, 0)));
      double const turn = 6.283185307179586 * to_unit(random_bits(1, RandomStream::pupil, i, 1));
      hits.push_back({150 + r * std::cos(turn), 150 + r * std::sin(turn)});
    }
    Both const both = lay_down(0.5, hits, 300);
    // 5e-5 at worst of each ray that lights a pixel: those of the nine pixels about it
    EXPECT_LT(largest_difference(both), 5e-5 * 9 / (3.14 * radius * radius)) << radius;
    double sum = 0;
    for (double const light : both.grid) sum += light;
    EXPECT_NEAR(sum, 1, 1e-9);
  }
}

}  // namespace
}  // namespace gladstone
