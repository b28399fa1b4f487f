#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "analysis/density/density_uncertainty.h"
#include "analysis/density/gradient_map.h"
#include "analysis/density/window_correlation.h"
#include "render/base/units.h"

/// Manufactured density fields with known gradient, for the tests of analysis/density.
namespace gladstone::inline density {

/// Returns a map of n x n nodes on the unit square with the given gradient(x, y); all nodes are valid.
template <class Gradient>
GradientMap make_map(int n, Gradient const& gradient) {
  GradientMap map;
  map.grid = {n, n, {0.0, 0.0}, {1.0 / (n - 1), 1.0 / (n - 1)}};
  map.valid.assign(map.grid.size(), 1);
  for (int row = 0; row < n; ++row)
    for (int column = 0; column < n; ++column) map.gradient.push_back(gradient(map.grid.position(column, row)));
  return map;
}

/// Returns the density of a smooth field that is not symmetric and whose normal derivatives do not vanish at any
/// border.
inline double wave_density(Vec2d p) { return std::sin(3.0 * p.x + 1.0) * std::cos(2.0 * p.y - 0.4) + 0.3 * p.x * p.y; }
inline Vec2d wave_gradient(Vec2d p) {
  return {3.0 * std::cos(3.0 * p.x + 1.0) * std::cos(2.0 * p.y - 0.4) + 0.3 * p.y,
          -2.0 * std::sin(3.0 * p.x + 1.0) * std::sin(2.0 * p.y - 0.4) + 0.3 * p.x};
}

/// Returns the density of a Gaussian of width s at the centre of the unit square.
inline double blob_density(Vec2d p, double s = 0.15) {
  double const x = p.x - 0.5, y = p.y - 0.5;
  return std::exp(-(x * x + y * y) / (s * s));
}
inline Vec2d blob_gradient(Vec2d p, double s = 0.15) {
  return (-2.0 / (s * s) * blob_density(p, s)) * Vec2d{p.x - 0.5, p.y - 0.5};
}

/// Returns a map whose gradient contains one random error with the standard deviation `sigma` of the map.
inline GradientMap with_noise(GradientMap map, WindowCorrelation const& correlation, std::uint64_t seed) {
  std::vector<Vec2d> const noise = draw_gradient_error(correlation, map.sigma, seed, 0);
  for (std::size_t i = 0; i < noise.size(); ++i) map.gradient[i] += noise[i];
  return map;
}

/// Largest and root-mean-square difference from density(x, y) over the finite nodes.
struct FieldError {
  double largest = 0.0, rms = 0.0;
  std::size_t count = 0;
};
template <class Density>
FieldError compare_with(PlaneGrid const& grid, std::vector<double> const& result, Density const& density) {
  FieldError error;
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      double const value = result[grid.index(column, row)];
      if (!std::isfinite(value)) continue;
      double const difference = value - density(grid.position(column, row));
      error.largest = std::max(error.largest, std::abs(difference));
      error.rms += difference * difference;
      ++error.count;
    }
  error.rms = std::sqrt(error.rms / static_cast<double>(error.count));
  return error;
}

}  // namespace gladstone::inline density
