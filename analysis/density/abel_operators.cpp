#include "analysis/density/abel_operators.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/density/lagrange_cubics.h"
#include "render/base/contracts.h"
#include "render/base/gauss_legendre.h"
#include "render/base/units.h"

namespace gladstone::inline density {
namespace {

/// Calls visit(x, weight) for each node of the quadrature of integral h(x) dx / sqrt(x^2 - r^2) over [low, high], with
/// r <= low and lengths in units of the spacing. The substitution x^2 = r^2 + y^2 turns dx / sqrt(x^2 - r^2) into dy /
/// x, which is smooth.
template <class Visit>
void integrate_abel_kernel(GaussLegendre const& rule, double r, double low, double high, Visit const& visit) {
  double const y0 = std::sqrt(std::max(0.0, low * low - r * r)), y1 = std::sqrt(high * high - r * r);
  for (std::size_t k = 0; k < rule.node.size(); ++k) {
    double const y = 0.5 * (y0 + y1) + 0.5 * (y1 - y0) * rule.node[k];
    double const x = std::sqrt(r * r + y * y);
    visit(x, 0.5 * (y1 - y0) * rule.weight[k] / x);
  }
}

}  // namespace

Eigen::MatrixXd make_gradient_inversion(int n) {
  GLADSTONE_EXPECTS(n >= 3);
  GaussLegendre const rule(12);
  Eigen::MatrixXd d = Eigen::MatrixXd::Zero(n, n);
  for (int i = 0; i < n; ++i)
    for (int j = i; j + 1 < n; ++j)
      integrate_abel_kernel(rule, i, j, j + 1, [&](double x, double weight) {
        std::array<double, 4> const cubic = lagrange_cubics(x - j);
        for (int k = 0; k < 4; ++k) {
          int const node = j - 1 + k;
          if (node == 0 || node >= n) continue;  // the gradient is zero on the axis and beyond the last radius
          double const sign = node < 0 ? -1.0 : 1.0;
          d(i, std::abs(node)) -= sign * weight * cubic[static_cast<std::size_t>(k)] / pi;
        }
      });
  return d;
}

Eigen::MatrixXd make_gradient_projection(int n) {
  GLADSTONE_EXPECTS(n >= 3);
  GaussLegendre const rule(12);
  Eigen::MatrixXd f = Eigen::MatrixXd::Zero(n, n);
  for (int i = 1; i < n; ++i)
    for (int j = i; j < n; ++j)
      integrate_abel_kernel(rule, i, j, j + 1, [&](double x, double weight) {
        std::array<double, 4> const slope = lagrange_cubic_slopes(x - j);
        for (int k = 0; k < 4; ++k) {
          int const node = std::abs(j - 1 + k);
          if (node < n) f(i, node) += 2.0 * i * weight * slope[static_cast<std::size_t>(k)];
        }
      });
  return f;
}

}  // namespace gladstone::inline density
