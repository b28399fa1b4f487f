#pragma once

#include <Eigen/Core>
#include <optional>

namespace gladstone::inline cases {

/// Returns the lower triangular Cholesky factor L, L L^T = R, of a matrix of correlation coefficients. L times
/// independent numbers of variance 1 gives numbers with these correlations (JCGM 101:2008, 6.4.8). R may be singular,
/// for instance with coefficients of 1 or -1; the columns of L that belong to dependent inputs are 0.
/// @return nullopt if R has a negative eigenvalue and so cannot be a correlation matrix
std::optional<Eigen::MatrixXd> correlation_factor(Eigen::MatrixXd const& coefficients);

}  // namespace gladstone::inline cases
