#include "analysis/tracking/dot_profile.h"

#include <Eigen/Cholesky>
#include <Eigen/QR>
#include <cmath>

#include "render/base/median.h"

namespace gladstone::inline tracking {
namespace {

constexpr int size = static_cast<int>(DotProfile::count);
constexpr double least_f_ratio = 6;
constexpr double usual_misfit = 3;  // largest ratio of a dot's residual to the median of all dots' residuals
constexpr int rounds = 4;           // number of iterations, each of which selects the dots with usual residuals again
// minimum rms misfit of the Gaussian for which it is replaced by another profile, relative to the light
constexpr double least_misfit = 0.005;
constexpr double ridge = 1e-9;  // regularisation of the shares towards zero, relative to the mean diagonal of
                                // the normal matrix

using Matrix = Eigen::Matrix<double, size, size>;
using Vector = Eigen::Matrix<double, size, 1>;

/// Normal equations of the fluxes of all Gaussians of the profile. The background and the shift of each dot have been
/// eliminated from them.
struct ProfileEquations {
  Matrix matrix = Matrix::Zero();
  Vector right = Vector::Zero();
  double squares = 0;  ///< weighted sum of the squared levels
  double freedom = 0;

  void add(ProfileEquations const& other) {
    matrix += other.matrix;
    right += other.right;
    squares += other.squares;
    freedom += other.freedom;
  }

  Vector solve() const {
    Matrix regular = matrix;
    regular.diagonal().array() += ridge * regular.diagonal().mean();
    return regular.ldlt().solve(right);
  }

  double residual(Vector const& light) const { return squares - 2 * right.dot(light) + light.dot(matrix * light); }

  /// Returns the weighted sum of squared residuals of the best fit of a single Gaussian.
  double gaussian_residual() const { return squares - right[size - 1] * right[size - 1] / matrix(size - 1, size - 1); }
};

/// @pre there are at least four samples
ProfileEquations dot_equations(std::vector<ProfileSample> const& samples) {
  auto const rows = static_cast<Eigen::Index>(samples.size());
  Eigen::MatrixXd gaussians(rows, size), eliminated(rows, 3);
  Eigen::VectorXd level(rows);
  for (Eigen::Index row = 0; row < rows; ++row) {
    ProfileSample const& one = samples[static_cast<std::size_t>(row)];
    double const root = std::sqrt(one.weight);
    for (int k = 0; k < size; ++k) gaussians(row, k) = root * one.gaussian[static_cast<std::size_t>(k)];
    eliminated.row(row) << root, root * one.by_centre.x, root * one.by_centre.y;
    level[row] = root * one.level;
  }
  Eigen::MatrixXd const basis = eliminated.householderQr().householderQ() * Eigen::MatrixXd::Identity(rows, 3);
  gaussians -= basis * (basis.transpose() * gaussians);
  level -= basis * (basis.transpose() * level);
  return {gaussians.transpose() * gaussians, gaussians.transpose() * level, level.squaredNorm(),
          static_cast<double>(rows - 3)};
}

/// Sums the equations of those dots whose ratio of squared residual to squared levels is at most three times the median
/// ratio.
ProfileEquations sum_usual(std::vector<ProfileEquations> const& dots, Vector const& light) {
  std::vector<double> misfit;
  for (ProfileEquations const& dot : dots) misfit.push_back(dot.residual(light) / dot.squares);
  double const most = usual_misfit * upper_median(misfit);
  ProfileEquations sum;
  for (std::size_t i = 0; i < dots.size(); ++i)
    if (misfit[i] <= most) sum.add(dots[i]);
  return sum;
}

}  // namespace

FittedProfile fit_dot_profile(std::span<std::vector<ProfileSample> const> dots) {
  std::vector<ProfileEquations> equations;
  for (std::vector<ProfileSample> const& dot : dots)
    if (dot.size() > 3) equations.push_back(dot_equations(dot));
  if (equations.empty()) return {};
  Vector light = Vector::Unit(size - 1);
  ProfileEquations sum;
  for (int round = 0; round < rounds; ++round) {
    sum = sum_usual(equations, light);
    light = sum.solve();
    if (!light.allFinite()) return {};
  }
  double const total = light.sum(), freedom = sum.freedom - size;
  double const of_profile = sum.residual(light), decrease = sum.gaussian_residual() - of_profile;
  bool const large = decrease > least_misfit * least_misfit * sum.squares;
  if (!large || !(total > 0.5) || !(decrease * freedom > least_f_ratio * (size - 1) * of_profile)) return {};
  FittedProfile fitted;
  fitted.flux_factor = total;
  for (int k = 0; k < size; ++k) fitted.profile.share[static_cast<std::size_t>(k)] = light[k] / total;
  return fitted;
}

}  // namespace gladstone::inline tracking
