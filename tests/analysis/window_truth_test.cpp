#include "analysis/errors/window_truth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "analysis/errors/scattered_grid.h"
#include "render/base/parallel.h"

namespace gladstone {
namespace {

std::vector<Vec2d> random_points(std::size_t count, double size) {
  std::mt19937_64 random(11);
  std::uniform_real_distribution<double> uniform(0.0, size);
  std::vector<Vec2d> points(count);
  for (Vec2d& p : points) p = {uniform(random), uniform(random)};
  return points;
}

std::vector<Vec2d> displaced(std::vector<Vec2d> const& points) {
  std::vector<Vec2d> d;
  for (Vec2d const& p : points) d.push_back({std::sin(0.1 * p.x) + 0.01 * p.y, 2.0 * std::cos(0.07 * p.y)});
  return d;
}

// Three dots with fluxes 1, 2, 3 at weights exp(-r^2/(2 sigma^2)), sigma = 4: T = sum f^2 W^2 d / sum f^2 W^2.
TEST(WindowTruth, WeighsWithSquaredWeightAndSquaredFlux) {
  std::vector<Vec2d> const position{{10.0, 10.0}, {12.0, 10.0}, {10.0, 13.0}};
  std::vector<Vec2d> const d{{1.0, 0.0}, {0.0, 1.0}, {-1.0, 2.0}};
  std::vector<double> const flux{1.0, 2.0, 3.0};
  std::vector<Vec2d> const centre{{10.0, 10.0}};
  WindowTruth const truth = window_truth(position, d, flux, centre, gaussian_window(4.0, 16.0), TruthAt::reference);
  double const w1 = 1.0, w2 = 4.0 * std::exp(-4.0 / 16.0), w3 = 9.0 * std::exp(-9.0 / 16.0);
  EXPECT_NEAR(truth.displacement_px[0].x, (w1 - w3) / (w1 + w2 + w3), 1e-15);
  EXPECT_NEAR(truth.displacement_px[0].y, (w2 + 2.0 * w3) / (w1 + w2 + w3), 1e-15);
}

// Dots at x = 0..63 move by d = 0.1 x; at mid-position they stand at 1.05 x, so the field there is d = x_mid/10.5 and
// a symmetric window over a lattice sees the value at its centre, the dot x = 20 standing at 21.
TEST(WindowTruth, CountsDotsAtMidPosition) {
  std::vector<Vec2d> position, d;
  for (int x = 0; x < 64; ++x) {
    for (int y = 0; y < 8; ++y) {
      position.push_back({static_cast<double>(x), static_cast<double>(y)});
      d.push_back({0.1 * x, 0.0});
    }
  }
  std::vector<Vec2d> const centre{{21.0, 3.5}};
  WindowTruth const mid = window_truth(position, d, {}, centre, gaussian_window(4.0, 12.0));
  EXPECT_NEAR(mid.displacement_px[0].x, 2.0, 1e-13);
  WindowTruth const one_sided = window_truth(position, d, {}, centre, gaussian_window(4.0, 12.0), TruthAt::reference);
  EXPECT_NEAR(one_sided.displacement_px[0].x, 2.1, 1e-13);
}

TEST(WindowTruth, LeavesOutWindowsWithFewerThanThreeDots) {
  double const nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Vec2d> const position{{0, 0}, {1, 0}, {2, 0}, {30, 0}, {31, 0}, {32, 0}, {60, 0}};
  std::vector<Vec2d> d(7, Vec2d{1.0, 1.0});
  d[5] = {nan, 1.0};  // a dot whose rays were all lost
  std::vector<Vec2d> const centres{{1, 0}, {31, 0}, {60, 0}, {500, 500}};
  WindowTruth const truth = window_truth(position, d, {}, centres, top_hat_window(8.0));
  EXPECT_EQ(truth.left_out, 3u);
  EXPECT_EQ(truth.displacement_px[0], (Vec2d{1.0, 1.0}));
  for (std::size_t i : {1u, 2u, 3u}) EXPECT_TRUE(std::isnan(truth.displacement_px[i].x));
}

TEST(WindowTruth, OfNoDotsLeavesAllOut) {
  std::vector<Vec2d> const centres(3);
  EXPECT_EQ(window_truth({}, {}, {}, centres, top_hat_window(8.0)).left_out, 3u);
}

// The cell grid finds exactly the dots of the support: the same sums as over all dots, to rounding.
TEST(WindowTruth, AgreesWithTheSumOverAllDotsForAnyNumberOfThreads) {
  std::vector<Vec2d> const position = random_points(2000, 200.0);
  std::vector<Vec2d> const d = displaced(position);
  std::vector<Vec2d> const centres = random_points(300, 220.0);
  WindowWeight const weight = gaussian_window(6.0, 16.0);
  int const before = thread_count();
  set_thread_count(1);
  WindowTruth const truth = window_truth(position, d, {}, centres, weight);
  set_thread_count(7);
  WindowTruth const again = window_truth(position, d, {}, centres, weight);
  set_thread_count(before);
  for (std::size_t i = 0; i < centres.size(); ++i) {
    Vec2d sum{};
    double total = 0.0;
    int dots = 0;
    for (std::size_t k = 0; k < position.size(); ++k) {
      Vec2d const o = position[k] + 0.5 * d[k] - centres[i];
      if (std::abs(o.x) > 16.0 || std::abs(o.y) > 16.0) continue;
      double const w = std::exp(-dot(o, o) / 36.0);
      sum += w * d[k];
      total += w;
      ++dots;
    }
    if (dots < 3) {
      EXPECT_TRUE(std::isnan(truth.displacement_px[i].x));
      continue;
    }
    EXPECT_EQ(truth.displacement_px[i], again.displacement_px[i]);
    EXPECT_NEAR(truth.displacement_px[i].x, sum.x / total, 1e-12);
    EXPECT_NEAR(truth.displacement_px[i].y, sum.y / total, 1e-12);
  }
}

// Local linear regression reproduces a plane wherever it has dots, at the edges as well: rounding only.
TEST(MapScattered, ReproducesAPlane) {
  std::vector<Vec2d> const position = random_points(1500, 128.0);
  std::vector<Vec2d> d;
  for (Vec2d const& p : position) d.push_back({0.5 + 0.02 * p.x - 0.03 * p.y, 0.01 * p.y});
  MapGrid const grid{65, 65, {0.0, 0.0}, 2.0};
  DisplacementMaps const maps = map_scattered(position, d, grid);
  for (int row = 0; row < 65; ++row) {
    for (int column = 0; column < 65; ++column) {
      EXPECT_NEAR(maps.u_px(column, row), 0.5 + 0.04 * column - 0.06 * row, 1e-9);
      EXPECT_NEAR(maps.v_px(column, row), 0.02 * row, 1e-9);
    }
  }
}

TEST(MapScattered, IsNotANumberFarFromEveryDot) {
  std::vector<Vec2d> const position = random_points(200, 20.0);
  DisplacementMaps const maps = map_scattered(position, displaced(position), {2, 1, {10.0, 10.0}, 200.0});
  EXPECT_TRUE(std::isfinite(maps.u_px(0, 0)));
  EXPECT_TRUE(std::isnan(maps.u_px(1, 0)));
}

}  // namespace
}  // namespace gladstone
