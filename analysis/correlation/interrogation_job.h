#pragma once

#include <string>
#include <vector>

#include "analysis/correlation/interrogation_grid.h"
#include "analysis/correlation/subpixel_fit.h"
#include "analysis/correlation/window_deformation.h"
#include "analysis/correlation/window_measurement.h"
#include "analysis/correlation/window_ops.h"

namespace gladstone {

class PlaneSums;

/// One pass over a pair: all windows of a grid are to be correlated.
struct InterrogationJob {
  ImagePair const& pair;
  InterrogationGrid const& grid;
  WindowWeighting weighting = WindowWeighting::gaussian;
  int search_radius_px = 1;  ///< largest shift looked for along either axis, at most half a window
  SubpixelFit fit = fit_gauss3;
  std::string label{};  ///< of the progress bar
  /// Of an ensemble: receives the planes of this pair, and gives the peaks of all so far; null: the pair by itself.
  PlaneSums* ensemble = nullptr;
};

/// One result a window of the grid; the same bits for any number of threads.
using CorrelateWindows = std::vector<WindowCorrelation> (*)(InterrogationJob const& job);

}  // namespace gladstone
