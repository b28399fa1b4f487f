#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "analysis/correlation/window_ops.h"
#include "render/base/vec.h"

namespace gladstone::inline errors {

/// Weight W(dx, dy) that a correlator applies to each image at a distance of (dx, dy) px from the window's centre. The
/// weight is zero for |dx| or |dy| > half_width_px.
struct WindowWeight {
  std::function<double(double dx_px, double dy_px)> value;
  double half_width_px = 0.0;
};

/// Returns the weight of a correlation pass.
/// @param window_px  nominal size of the interrogation window [px]
WindowWeight correlation_window(WindowWeighting weighting, double window_px);

/// Position assigned to a dot: the middle of the dot's displacement for symmetric image deformation, the dot's position
/// in frame A for one-sided methods.
enum class TruthAt { mid_position, reference };

/// True displacement at every vector; NaN at excluded vectors.
struct WindowTruth {
  std::vector<Vec2d> displacement_px;
  std::size_t left_out = 0;  ///< number of excluded vectors: those with fewer than three dots in their window
};

/// Computes the true window displacement T(c) = sum a W^2(x - c) d / sum a W^2(x - c), summed over the dots. W is
/// squared because the product of two weighted images is correlated; a is the squared flux of the dot, and x is its
/// position (see TruthAt). Runs on thread_count() threads; the result does not depend on their number.
/// @param reference_px     positions of the dots in frame A [px]
/// @param displacement_px displacements of the dots [px]; dots with NaN are ignored
/// @param flux light fluxes of the dots, in any unit; empty: all dots have the same flux
/// @param centres_px       positions of the vectors [px]
WindowTruth window_truth(std::span<Vec2d const> reference_px, std::span<Vec2d const> displacement_px,
                         std::span<double const> flux, std::span<Vec2d const> centres_px, WindowWeight const& weight,
                         TruthAt at = TruthAt::mid_position);

}  // namespace gladstone::inline errors
