#pragma once

#include <Eigen/Core>

namespace gladstone::density {

/// Linear operators of the Abel transform on n radii r_i = i h, i = 0 to n - 1, from the axis outwards. The excess
/// density f(r) over the ambient one is zero beyond the last radius; f is even and the projected gradient odd about the
/// axis. Operators act on column vectors of n values.

/// Inverse of the projected gradient g = dP/dx, which a deflection measures directly:
///   f(r) = -(1/pi) integral g dx / sqrt(x^2 - r^2)
/// with g interpolated by cubics through four nodes. No differentiation of data; fourth order for smooth fields.
/// @return D [n, n, 1]: f = D g, with f in the unit of g
Eigen::MatrixXd make_gradient_inversion(int n);

/// Projected gradient of an excess density: g(x) = 2 x integral f'(r) dr / sqrt(r^2 - x^2), with f interpolated by
/// cubics through four nodes.
/// @return F [n, n, 1]: g = F f, with g in the unit of f
Eigen::MatrixXd make_gradient_projection(int n);

}  // namespace gladstone::density
