#include <Eigen/Dense>
#include <cmath>

#include "analysis/correlation/subpixel_fit.h"

namespace gladstone {

PeakFit fit_gauss2d(PeakPatch const& patch) {
  Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
  Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
  double const middle = patch.value[1][1];
  for (int y = -1; y <= 1; ++y)
    for (int x = -1; x <= 1; ++x) {
      double const value = patch.value[y + 1][x + 1] / middle;
      if (!(value > 0.0)) return fit_gauss3(patch);
      Eigen::Matrix<double, 6, 1> const terms{1.0, double(x), double(y), double(x * x), double(x * y), double(y * y)};
      normal += value * value * terms * terms.transpose();
      right += value * value * std::log(value) * terms;
    }
  Eigen::Matrix<double, 6, 1> const c = normal.ldlt().solve(right);
  double const determinant = 4.0 * c[3] * c[5] - c[4] * c[4];
  if (!(c[3] < 0.0) || !(determinant > 0.0)) return fit_gauss3(patch);
  double const x = (c[4] * c[2] - 2.0 * c[5] * c[1]) / determinant;
  double const y = (c[4] * c[1] - 2.0 * c[3] * c[2]) / determinant;
  if (!(std::abs(x) <= 1.0 && std::abs(y) <= 1.0)) return fit_gauss3(patch);
  return {x, y, c[0] + 0.5 * (c[1] * x + c[2] * y)};
}

}  // namespace gladstone
