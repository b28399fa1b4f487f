#pragma once

#include <cmath>
#include <functional>
#include <vector>

#include "analysis/uncertainty/uncertainty.h"

namespace gladstone {

/// What the windows of the last pass have in common.
struct WindowShape {
  int side;                 ///< pixels along an axis
  std::vector<float> axis;  ///< weights along either; zeros behind them, up to a multiple of eight
};
WindowShape window_shape(CorrelationSettings const& settings, InterrogationGrid const& grid);

/// Where in the image a vector's window begins.
Vec2<int> first_pixel(InterrogationGrid const& grid, std::size_t vector, int side);

/// The pixels of one window of matched frames, row by row.
struct MatchedWindow {
  int side;                      ///< pixels along an axis
  std::vector<float> reference;  ///< less the weighted mean; 0 outside the image
  std::vector<float> flow;       ///< likewise, and made as bright as the reference: equal sums of squares, weighted
  std::vector<float> weight;     ///< that the correlator puts on either frame; 0 outside the image and where unknown

  std::size_t at(int i, int j) const { return static_cast<std::size_t>(j) * side + i; }
};

/// Calls visit(vector, window) for every valid vector, on all threads.
void visit_matched_windows(UncertaintyInput const& input,
                           std::function<void(std::size_t vector, MatchedWindow const& window)> const& visit);

/// mean_of_neighbours() of every value.
std::vector<double> averaged_over_neighbours(std::vector<double> const& values, InterrogationGrid const& grid);

/// Standard uncertainties from the variances along both axes, averaged so [px].
std::vector<Vec2d> sigma_of_variances(std::vector<double> const& u, std::vector<double> const& v,
                                      InterrogationGrid const& grid);

}  // namespace gladstone
