#include "studies/report/twin_density.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/base/error.h"

namespace gladstone {
namespace {

constexpr int columns = 9, rows = 7;
constexpr double spacing = 0.5e-3;

/// Gradients of rho = 3 x + 200 x^2 + 100 x y - 50 y^2, X right and Y up, relative to the middle of the lattice.
double density_at(double x, double y) { return 3 * x + 200 * x * x + 100 * x * y - 50 * y * y; }
std::vector<Vec2d> gradients() {
  std::vector<Vec2d> gradient;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      double const x = spacing * (column - (columns - 1) / 2.0), y = -spacing * (row - (rows - 1) / 2.0);
      gradient.push_back({3 + 400 * x + 100 * y, 100 * x - 100 * y});
    }
  }
  return gradient;
}

double quadratic(int column, int row) {
  return density_at(spacing * (column - (columns - 1) / 2.0), -spacing * (row - (rows - 1) / 2.0));
}

// Between two nodes the mean of both gradients is exact for a quadratic field; the level is the mean over the border.
TEST(TwinDensity, IntegratesAQuadraticFieldExactly) {
  Image<double> const density = compute_twin_density(gradients(), columns, rows, spacing);
  double const level = density(4, 3) - quadratic(4, 3);
  double border = 0;
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      EXPECT_NEAR(density(column, row), quadratic(column, row) + level, 1e-10);
      bool const edge = row == 0 || column == 0 || row == rows - 1 || column == columns - 1;
      border += edge ? density(column, row) : 0;
    }
  }
  EXPECT_NEAR(border, 0, 1e-10);
}

// An unknown vector is a hole: the density around it is the same.
TEST(TwinDensity, IgnoresUnknownVectors) {
  std::vector<Vec2d> gradient = gradients();
  gradient[3 * columns + 4] = {std::nan(""), std::nan("")};
  Image<double> const density = compute_twin_density(gradient, columns, rows, spacing);
  double const level = density(0, 0) - quadratic(0, 0);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      if (row == 3 && column == 4) continue;
      EXPECT_NEAR(density(column, row), quadratic(column, row) + level, 1e-8);
    }
  }
}

// A corner cut off by unknown vectors has no known level: it continues its surroundings smoothly, here a constant.
TEST(TwinDensity, ContinuesTheLargestRegion) {
  std::vector<Vec2d> gradient(columns * rows);
  for (int const cut : {1, columns, columns + 1}) gradient[cut] = {std::nan(""), std::nan("")};
  gradient[0] = {1e3, 1e3};
  Image<double> const density = compute_twin_density(gradient, columns, rows, spacing);
  for (double const value : density) EXPECT_NEAR(value, 0, 1e-9);
}

TEST(TwinDensity, RequiresAKnownVector) {
  std::vector<Vec2d> const unknown(columns * rows, Vec2d{std::nan(""), std::nan("")});
  EXPECT_THROW(compute_twin_density(unknown, columns, rows, spacing), DataError);
}

}  // namespace
}  // namespace gladstone
