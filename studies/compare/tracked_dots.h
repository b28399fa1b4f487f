#pragma once

#include <span>
#include <vector>

#include "analysis/correlation/correlation_settings.h"
#include "analysis/errors/window_truth.h"
#include "render/scene/ground_truth.h"
#include "render/scene/setup.h"

namespace gladstone::inline compare {

/// Adds the positions of the dots of a BOS target in the reference image to settings of dot tracking, which then
/// searches for no others; changes no other settings.
CorrelationSettings with_known_dots(CorrelationSettings settings, Setup const& setup,
                                    std::vector<Vec2d> const& reference_px);

/// Computes the displacements that dot tracking would measure if it located every dot without error.
///
/// - Vectors on a grid: the truth of the dots in view, interpolated like the measured vectors (adaptive Gaussian
///   window). Dots with less than a tenth of the median light are ignored.
/// - Scattered vectors: the truth at each vector. A dot does not average over a window.
/// @param flux          light of the dots, in any unit
/// @param point_truth   true displacement at each vector [px]
/// @param position_px   positions of the vectors
/// @return `left_out` is the number of vectors without dots near them
WindowTruth tracked_truth(GroundTruth const& dots, std::span<double const> flux, CameraSetup const& camera,
                          std::vector<Vec2d> const& point_truth, std::vector<Vec2d> const& position_px,
                          CorrelationSettings const& settings, TruthAt at);

}  // namespace gladstone::inline compare
