#pragma once

#include <string>
#include <vector>

#include "analysis/correlation/interrogation_grid.h"
#include "analysis/correlation/subpixel_fit.h"
#include "analysis/correlation/window_deformation.h"
#include "analysis/correlation/window_measurement.h"
#include "analysis/correlation/window_ops.h"

namespace gladstone::inline correlation {

class PlaneSums;

/// Task of one pass: correlate all windows of a grid on one pair of images.
struct InterrogationJob {
  ImagePair const& pair;
  InterrogationGrid const& grid;
  WindowWeighting weighting = WindowWeighting::gaussian;
  int search_radius_px = 1;  ///< largest shift searched along either axis, at most half a window [px]
  SubpixelFit fit = fit_gauss3;
  std::string label{};  ///< label of the progress bar
  /// Accumulator of an ensemble. The planes of this pair are added to it, and the peaks are searched in the mean over
  /// all pairs so far. Null: the peaks are searched in the planes of this pair.
  PlaneSums* ensemble = nullptr;
};

/// Correlates all windows of a job and returns one result per window of the grid, bitwise the same for any number of
/// threads.
using CorrelateWindows = std::vector<WindowCorrelation> (*)(InterrogationJob const& job);

}  // namespace gladstone::inline correlation
