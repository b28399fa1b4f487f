#pragma once

#include <functional>
#include <vector>

#include "analysis/uncertainty/uncertainty.h"

namespace gladstone::inline uncertainty {

/// Size and weights common to the windows of the last pass.
struct WindowShape {
  int side;                 ///< side of the support [px]
  std::vector<float> axis;  ///< weights along either axis, followed by zeros up to a multiple of eight
};
WindowShape window_shape(CorrelationSettings const& settings, InterrogationGrid const& grid);

/// Returns the image position of the first pixel of a vector's window [px].
Vec2<int> first_pixel(InterrogationGrid const& grid, std::size_t vector, int side);

/// Pixels of one window of the matched frames, row by row.
struct MatchedWindow {
  int side;                      ///< side of the support [px]
  std::vector<float> reference;  ///< grey levels of frame A minus their weighted mean; 0 where the weight is 0
  /// Grey levels of frame B minus their weighted mean, scaled to the same weighted sum of squares as frame A.
  std::vector<float> flow;
  /// Weights that the correlator applies to each frame; 0 at pixels that are unknown or outside the image.
  std::vector<float> weight;

  std::size_t at(int i, int j) const { return static_cast<std::size_t>(j) * side + i; }
};

/// Calls visit(vector, window) for every valid vector, on all threads.
void visit_matched_windows(UncertaintyInput const& input,
                           std::function<void(std::size_t vector, MatchedWindow const& window)> const& visit);

/// Replaces every value by the mean over its 3 x 3 neighbourhood, see mean_of_neighbours().
std::vector<double> averaged_over_neighbours(std::vector<double> const& values, InterrogationGrid const& grid);

/// Returns the standard uncertainties from the variances along both axes, averaged over neighbours [px].
std::vector<Vec2d> sigma_of_variances(std::vector<double> const& u, std::vector<double> const& v,
                                      InterrogationGrid const& grid);

}  // namespace gladstone::inline uncertainty
