#pragma once

#include <span>

namespace gladstone::inline files {

/// Converts N nodal values f in place into the coefficients c of the interpolating uniform cubic B-spline with
/// not-a-knot ends, including one coefficient beyond either end (ghost). With f = c + delta^2 c / 6, the end condition
/// delta^4 c = 0 at the second node gives c_1 = f_1 - delta^2 f_1 / 6 directly (likewise c_{N-2}); the coefficients
/// between them follow from a tridiagonal system, the ghosts from the interpolation conditions. Three nodes give a
/// parabola, two a line, one a constant.
/// @param line     ghost, N values, ghost: N + 2 numbers, of which the ghosts are only outputs
/// @param scratch  at least N numbers
void prefilter_open(std::span<double> line, std::span<double> scratch);

/// Converts N >= 1 periodic nodal values in place into B-spline coefficients; none are added beyond the ends.
/// Recursive filter with pole sqrt(3) - 2 and exact periodic starting sums (Unser et al. 1993).
void prefilter_periodic(std::span<double> line);

}  // namespace gladstone::inline files
