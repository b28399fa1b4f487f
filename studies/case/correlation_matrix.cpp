#include "studies/case/correlation_matrix.h"

#include <cmath>

namespace gladstone::inline cases {

std::optional<Eigen::MatrixXd> correlation_factor(Eigen::MatrixXd const& coefficients) {
  constexpr double rounding = 1e-12;
  Eigen::Index const n = coefficients.rows();
  Eigen::MatrixXd factor = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index k = 0; k < n; ++k) {
    double const pivot = coefficients(k, k) - factor.row(k).squaredNorm();
    if (pivot < -rounding) return std::nullopt;
    bool const follows = pivot <= rounding;  // whether input k is a linear combination of the inputs before it
    if (!follows) factor(k, k) = std::sqrt(pivot);
    for (Eigen::Index i = k + 1; i < n; ++i) {
      double const rest = coefficients(i, k) - factor.row(i).dot(factor.row(k));
      if (follows && std::abs(rest) > 1e-6) return std::nullopt;  // sqrt(rounding)
      if (!follows) factor(i, k) = rest / factor(k, k);
    }
  }
  return factor;
}

}  // namespace gladstone::inline cases
