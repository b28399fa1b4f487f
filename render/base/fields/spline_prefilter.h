#pragma once

#include <span>

namespace gladstone {

/// Turns N nodal values into the coefficients of the interpolating uniform cubic B-spline, in place.
/// Open ends are not-a-knot: with f = c + delta^2 c / 6 the condition delta^4 c = 0 at the second node gives
/// c_1 = f_1 - delta^2 f_1 / 6 at once (likewise c_{N-2}), a tridiagonal system remains in between, and the ghosts
/// follow from the interpolation conditions. Three nodes give the parabola, two the line, one a constant.
/// @param line   ghost, N values, ghost: N + 2 numbers, the ghosts are outputs
/// @param scratch at least N numbers
void prefilter_open(std::span<double> line, std::span<double> scratch);

/// The same for a periodic line of N >= 1 values without ghosts.
/// Recursive filter with pole sqrt(3) - 2 and exact periodic starting sums (Unser et al. 1993).
void prefilter_periodic(std::span<double> line);

}  // namespace gladstone
