#include "studies/compare/density_warnings.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tests/support/expect_warning.h"

namespace gladstone {
namespace {

constexpr double wave_amplitude = 3e-3, wave_length = 0.04;  // of the gradient [kg/m^3]; [m]

density::ProjectionOptics optics() { return {0.1, 0.75, 0.25, 10e-6, 2.3e-4, 1.0003, {}}; }

/// Gradient of a potential sin(k x) sin(k y) over two waves in each direction, on 81 x 81 nodes.
density::GradientMap waves(double noise) {
  density::GradientMap map;
  map.grid = {81, 81, {}, {1e-3, 1e-3}};
  map.valid.assign(map.grid.size(), 1);
  std::mt19937 random(7);
  std::normal_distribution<double> normal(0.0, noise > 0.0 ? noise : 1.0);
  double const k = 2.0 * M_PI / wave_length;
  for (int row = 0; row < 81; ++row)
    for (int column = 0; column < 81; ++column) {
      Vec2d const p = map.grid.position(column, row);
      Vec2d gradient{wave_amplitude * std::cos(k * p.x) * std::sin(k * p.y),
                     wave_amplitude * std::sin(k * p.x) * std::cos(k * p.y)};
      if (noise > 0.0) gradient = gradient + Vec2d{normal(random), normal(random)};
      map.gradient.push_back(gradient);
    }
  return map;
}

// Each of the four derivatives has an rms of k A / 2, so that their root sum of squares is k A. The displacement is s
// times the gradient, and a pixel p/M_A wide in the flow. Central differences reduce waves of 40 nodes by 0.4 %, and
// 79 instead of 80 nodes per two waves contribute 1 %.
TEST(DisplacementGradient, IsThatOfWaves) {
  double const pixel = optics().pixel_pitch / optics().medium_magnification();
  double const expected = optics().sensitivity() * pixel * wave_amplitude * 2.0 * M_PI / wave_length;
  EXPECT_NEAR(compute_displacement_gradient(waves(0.0), optics()) / expected, 1.0, 0.02);
}

// Noise of a fifth of the wave_amplitude A changes it by its statistical uncertainty only. On its own it has a mean
// squared divergence of (0.2 A / h)^2 = 1.6 (k A)^2, as much as its squared curl. Their difference scatters by twice
// that over the root of the number of independent values, about half of 6241: 6 %.
TEST(DisplacementGradient, ExcludesNoise) {
  double const clean = compute_displacement_gradient(waves(0.0), optics());
  double const noisy = compute_displacement_gradient(waves(0.2 * wave_amplitude), optics());
  EXPECT_NEAR(noisy * noisy / (clean * clean), 1.0, 3 * 0.06);
}

TEST(DisplacementGradient, IsWarnedOf) {
  Reconstruction result;
  density::GradientMap map = waves(0.0);
  warn_of_displacement_gradient(result, map, optics());
  EXPECT_TRUE(result.warnings.empty());
  double const factor = 0.02 / compute_displacement_gradient(map, optics());
  for (Vec2d& gradient : map.gradient) gradient = factor * gradient;
  warn_of_displacement_gradient(result, map, optics());
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_THAT(result.warnings.front(), Warns("low_accuracy at geometry.z_d_mm", testing::HasSubstr("0.02 px")));
}

// Without a difference between neighbours nothing is known of the gradient.
TEST(DisplacementGradient, IsUnknownForIsolatedVectors) {
  density::GradientMap map = waves(0.0);
  for (std::size_t i = 0; i < map.valid.size(); ++i) map.valid[i] = i % 3 == 0;  // of 81 columns: every third
  EXPECT_TRUE(std::isnan(compute_displacement_gradient(map, optics())));
}

// The mean over a window of w x w changes a wave sin(k x) sin(k y) by the factor (sin(k w / 2) / (k w / 2))^2 - 1, here
// with w = 4 mm = 4 nodes and k w / 2 = 0.314: -0.0326. The series of second order with differences over w / 2 gives
// 2 (cos(k w / 2) - 1) / 3, -0.0326 to 1 %. The rms of the wave is 1/2.
TEST(WindowEffect, IsThatOfTheMeanOverAWindow) {
  Reconstruction result;
  result.grid = waves(0.0).grid;
  result.overlap = {4.0, 4.0};
  double const k = 2.0 * M_PI / wave_length, half = 0.5 * k * 4e-3;
  for (int row = 0; row < 81; ++row)
    for (int column = 0; column < 81; ++column) {
      Vec2d const p = result.grid.position(column, row);
      result.density.push_back(std::sin(k * p.x) * std::sin(k * p.y));
    }
  double const expected = (1.0 - std::pow(std::sin(half) / half, 2)) / 2.0;
  result.sigma.assign(result.grid.size(), 2.0 * expected);
  // Along each axis 77 of the 80 nodes of two waves count, without those next to a zero: 80 / 77, or 4 %.
  EXPECT_NEAR(estimate_window_effect(result).change / expected, 80.0 / 77.0, 0.015);
  warn_of_window(result);
  EXPECT_TRUE(result.warnings.empty());
  result.sigma.assign(result.grid.size(), 0.5 * expected);
  warn_of_window(result);
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_THAT(result.warnings.front(), Warns("low_accuracy at correlate.window_px"));
}

TEST(WindowEffect, IsUnknownWithoutUncertainty) {
  Reconstruction result;
  result.grid = {5, 5, {}, {1e-3, 1e-3}};
  result.density.assign(25, 1.0);
  result.density[12] = 2.0;
  result.sigma.assign(25, NAN);
  warn_of_window(result);
  EXPECT_TRUE(result.warnings.empty());
}

TEST(ReferenceRegion, OfAllVectorsIsWarnedOf) {
  Reconstruction result;
  result.gradient = {{1.0, 0.0}, {-1.0, 0.0}};
  result.reference = {1, 1};
  warn_of_reference_gradient(result);
  ASSERT_EQ(result.warnings.size(), 1u);
  EXPECT_THAT(result.warnings.front(), Warns("unsuitable at reference"));
}

}  // namespace
}  // namespace gladstone
