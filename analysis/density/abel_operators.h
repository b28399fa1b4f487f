#pragma once

#include <Eigen/Core>

namespace gladstone::inline density {

/// Linear operators of the Abel transform on n radii r_i = i h, i = 0 to n - 1, from the axis outwards. The excess
/// density f(r), density minus ambient density, is zero beyond the last radius. About the axis, f is even and the
/// projected gradient is odd. Operators act on column vectors of n values.

/// Returns the operator that converts the projected gradient g = dP/dx, which a deflection measures directly, to the
///   excess density: f(r) = -(1/pi) integral g dx / sqrt(x^2 - r^2) with g interpolated by cubics through four nodes.
///   No data are differentiated; the error is of fourth order for smooth fields.
/// @return D [n, n, 1]: f = D g, with f in the unit of g
Eigen::MatrixXd make_gradient_inversion(int n);

/// Returns the operator that projects an excess density to its gradient: g(x) = 2 x integral f'(r) dr / sqrt(r^2 -
/// x^2), with f interpolated by cubics through four nodes.
/// @return F [n, n, 1]: g = F f, with g in the unit of f
Eigen::MatrixXd make_gradient_projection(int n);

}  // namespace gladstone::inline density
