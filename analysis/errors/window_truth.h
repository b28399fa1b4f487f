#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "render/base/vec.h"

namespace gladstone {

/// The weight that a correlator puts on each image in its last pass: W(dx, dy) at (dx, dy) px from the window's
/// centre, zero beyond half_width_px in either direction.
struct WindowWeight {
  std::function<double(double dx_px, double dy_px)> value;
  double half_width_px = 0.0;
};

/// W = exp(-(dx^2 + dy^2)/(2 sigma^2)) within the square |dx|, |dy| <= half_width.
WindowWeight gaussian_window(double sigma_px, double half_width_px);
/// W = 1 on the window's own pixels: a dot at |dx|, |dy| <= window_px/2.
WindowWeight top_hat_window(double window_px);

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

/// Truth on a window of deformed frames: the plane that fits the displacements of the window's dots best, with the
/// weights a W^2 of window_truth(), at the window's centre. Frames that a predictor deforms keep only what it leaves
/// of the displacement; its gradient is gone, and with it what T has of the gradient times the distance of the dots'
/// centre from the window's. So of one pass, which deforms nothing, window_truth() is what is measured, and of several
/// this is. The mean T where the dots stand in line (across the line less than a thousandth of their extent along it);
/// left out where there are fewer than three, as above.
WindowTruth deformed_window_truth(std::span<Vec2d const> reference_px, std::span<Vec2d const> displacement_px,
                                  std::span<double const> flux, std::span<Vec2d const> centres_px,
                                  WindowWeight const& weight, TruthAt at = TruthAt::mid_position);

}  // namespace gladstone
