#pragma once

#include <span>

#include "analysis/correlation/correlation_settings.h"
#include "analysis/errors/window_truth.h"

namespace gladstone::inline errors {

/// Computes the true window displacement for multi-pass correlation with image deformation. It applies the passes to
/// the true dot displacements, without noise and to first order in the residual displacement. Each pass deforms both
/// frames by the predictor P of the previous pass and measures the residual. At the centre c of a window,
///   T_k(c) = P(c) + sum a W^2(x - c) (d - P(x)) / sum a W^2(x - c),   P = 0 in the first pass,
/// with the pass's own window weight W. The P of the next pass is interpolated from the nodes after filling and
/// smoothing, as in the correlator. The positions of the dots in the window therefore affect the result only where
/// d - P has a gradient, and the flow's curvature affects it only to the extent that the passes cannot resolve it. For
/// a single pass the result equals window_truth().
/// @param settings      windows, overlap, weighting and passes; windows larger than the frame are skipped
/// @param columns,rows  size of the frames [px]
/// @return true window displacements, as window_truth() returns them; the other parameters are described there
WindowTruth deformed_window_truth(std::span<Vec2d const> reference_px, std::span<Vec2d const> displacement_px,
                                  std::span<double const> flux, std::span<Vec2d const> centres_px,
                                  CorrelationSettings const& settings, int columns, int rows,
                                  TruthAt at = TruthAt::mid_position);

}  // namespace gladstone::inline errors
