#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "analysis/correlation/window_ops.h"
#include "render/base/vec.h"

namespace gladstone {

/// The weight that a correlator puts on each image: W(dx, dy) at (dx, dy) px from the window's
/// centre, zero beyond half_width_px in either direction.
struct WindowWeight {
  std::function<double(double dx_px, double dy_px)> value;
  double half_width_px = 0.0;
};

/// W of a correlator's pass.
/// @param window_px nominal window size
WindowWeight correlation_window(WindowWeighting weighting, double window_px);

/// Where a dot counts: symmetric deformation measures at mid-position, one-sided codes at the reference.
enum class TruthAt { mid_position, reference };

/// True displacement at every vector, NaN where left out.
struct WindowTruth {
  std::vector<Vec2d> displacement_px;
  std::size_t left_out = 0;  ///< vectors with fewer than three dots on their window
};

/// Truth on the window: T(c) = sum a W^2(x - c) d / sum a W^2(x - c) over the dots, because the product of two
/// weighted images carries W^2; a is the squared flux of the dot and x = reference + d/2 (or the reference).
/// @param reference_px,displacement_px of the dots; those with NaN count nowhere
/// @param flux       of the dots, any unit; empty: all equal
/// @param centres_px of the vectors
/// Runs on thread_count() threads; the sums do not depend on their number.
WindowTruth window_truth(std::span<Vec2d const> reference_px, std::span<Vec2d const> displacement_px,
                         std::span<double const> flux, std::span<Vec2d const> centres_px, WindowWeight const& weight,
                         TruthAt at = TruthAt::mid_position);

}  // namespace gladstone
