#pragma once

#include <Eigen/Core>
#include <optional>

namespace gladstone {

/// L with L L^T = R, lower triangular, of a matrix of correlation coefficients (Cholesky's): independent numbers of
/// variance 1 times L are correlated so (JCGM 101:2008, 6.4.8). Where inputs follow from one another, coefficients of 1
/// or -1 among them, columns of L are 0. Nothing where R is of no correlations: it has a negative eigenvalue.
std::optional<Eigen::MatrixXd> correlation_factor(Eigen::MatrixXd const& coefficients);

}  // namespace gladstone
