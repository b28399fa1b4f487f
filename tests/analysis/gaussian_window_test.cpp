#include "analysis/tracking/gaussian_window.h"

#include <gtest/gtest.h>

#include "analysis/tracking/outlier_test.h"
#include "tests/analysis/synthetic_dots.h"

namespace gladstone::inline tracking {
namespace {

/// Vectors at random places with values of a field and noise.
template <class Field>
DisplacementField scattered(double sigma, Field const& field) {
  KeyedEngine random(17, RandomStream::particles, 0);
  DisplacementField vectors;
  vectors.position_px = test::random_places(2000, 300, 3, random);
  for (Vec2d const p : vectors.position_px) {
    vectors.displacement_px.push_back(field(p) + sigma * Vec2d{normal_variate(random), normal_variate(random)});
    vectors.sigma_px.push_back({sigma, sigma});
  }
  return vectors;
}

/// Interpolates vectors onto a regular grid.
DisplacementField grid_vectors(DisplacementField const& vectors, int columns, int rows, Vec2d first_px, double step_px,
                               GaussianWindow const& window = {}) {
  std::vector<Vec2d> nodes;
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column)
      nodes.push_back(first_px + step_px * Vec2d{1.0 * column, 1.0 * row});
  return interpolate_vectors(vectors, nodes, window);
}

// A plane fitted to values of a plane is that plane, for any positions of the vectors.
TEST(GaussianWindow, ReproducesLinearFields) {
  auto const field = [](Vec2d p) { return Vec2d{1 + 0.02 * p.x - 0.01 * p.y, 0.03 * p.y}; };
  DisplacementField const grid = grid_vectors(scattered(0, field), 25, 25, {15, 15}, 11);
  ASSERT_EQ(grid.size(), 625u);
  for (std::size_t i = 0; i < grid.size(); ++i) {
    ASSERT_TRUE(grid.counts(i));
    EXPECT_LT(length(grid.displacement_px[i] - field(grid.position_px[i])), 1e-9);
  }
}

// Independent errors of the vectors: those at the nodes have the propagated standard deviation. Neighbouring nodes
// share no vectors at 40 px.
TEST(GaussianWindow, PropagatesTheUncertainty) {
  auto const field = [](Vec2d) { return Vec2d{2, -1}; };
  for (WindowOrder const order : {WindowOrder::mean, WindowOrder::plane}) {
    GaussianWindow window;
    window.order = order;
    DisplacementField const grid = grid_vectors(scattered(0.1, field), 28, 28, {12, 12}, 10, window);
    double normalised = 0, variance = 0;
    for (std::size_t i = 0; i < grid.size(); ++i) {
      Vec2d const error = grid.displacement_px[i] - field({});
      normalised += std::pow(error.x / grid.sigma_px[i].x, 2) + std::pow(error.y / grid.sigma_px[i].y, 2);
      variance += std::pow(grid.sigma_px[i].x, 2);
    }
    double const nodes = static_cast<double>(grid.size());
    // 1568 numbers, of which a fifth share half of their vectors: about 3 %
    EXPECT_NEAR(std::sqrt(normalised / (2 * nodes)), 1.0, 0.09);
    // Weights exp(-r^2/H^2) average 2 pi H^2 count / area = 2 (H / spacing)^2 = 3.1 vectors; a plane through irregular
    // places is noisier than the mean.
    EXPECT_NEAR(std::sqrt(variance / nodes) / (0.1 / std::sqrt(2 * 1.24 * 1.24)), 1.0, 0.25);
  }
}

TEST(GaussianWindow, LeavesPointsWithoutVectorsInvalid) {
  DisplacementField vectors = scattered(0, [](Vec2d) { return Vec2d{1, 1}; });
  for (std::size_t i = 0; i < vectors.size(); ++i)
    vectors.status.push_back(vectors.position_px[i].x < 200 ? VectorStatus::valid : VectorStatus::invalid);
  std::vector<Vec2d> const points{{100, 100}, {280, 100}};
  DisplacementField const found = interpolate_vectors(vectors, points);
  EXPECT_TRUE(found.counts(0));
  EXPECT_FALSE(found.counts(1));
  EXPECT_FALSE(interpolate_vectors({}, points).counts(0));
}

TEST(OutlierTest, FindsWrongVectorsAndNoOthers) {
  DisplacementField vectors = scattered(0.05, [](Vec2d p) { return Vec2d{0.02 * p.x, 0.01 * p.y}; });
  std::vector<char> wrong(vectors.size());
  for (std::size_t i = 7; i < vectors.size(); i += 37) {
    vectors.displacement_px[i] += Vec2d{1.5, -1};
    wrong[i] = 1;
  }
  auto const outliers = find_outliers(vectors.position_px, vectors.displacement_px);
  int missed = 0, strays = 0, all = 0;
  for (std::size_t i = 0; i < wrong.size(); ++i) {
    all += wrong[i];
    missed += wrong[i] && !outliers[i] ? 1 : 0;
    strays += !wrong[i] && outliers[i] ? 1 : 0;
  }
  EXPECT_LE(missed, all / 20);
  EXPECT_LE(strays, 20);
}

}  // namespace
}  // namespace gladstone::inline tracking
