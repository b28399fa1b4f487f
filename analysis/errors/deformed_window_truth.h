#pragma once

#include <span>

#include "analysis/correlation/correlation_settings.h"
#include "analysis/errors/window_truth.h"

namespace gladstone {

/// Truth on the windows of frames that the passes deform: what the passes make of the dots' own displacements, without
/// noise and to first order in what is left of them. A pass deforms both frames by the predictor P of the pass before
/// and measures the rest, at a window's centre c
///   T_k(c) = P(c) + sum a W^2(x - c) (d - P(x)) / sum a W^2(x - c),   P = 0 in the first pass,
/// with W of its own window, and gives the next P by its nodes, filled and smoothed as the correlator does it. So the
/// place of the dots in the window counts only as far as P has left a gradient, and of the flow's curvature stays what
/// the passes cannot follow. Of one pass it is window_truth().
/// @param settings windows, overlap, weighting and passes; windows larger than the frame are passed over
/// @param columns,rows of the frames
/// The other parameters, and what is left out, as of window_truth().
WindowTruth deformed_window_truth(std::span<Vec2d const> reference_px, std::span<Vec2d const> displacement_px,
                                  std::span<double const> flux, std::span<Vec2d const> centres_px,
                                  CorrelationSettings const& settings, int columns, int rows,
                                  TruthAt at = TruthAt::mid_position);

}  // namespace gladstone
