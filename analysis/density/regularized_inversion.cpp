#include "analysis/density/regularized_inversion.h"

#include <Eigen/Cholesky>
#include <cmath>
#include <vector>

#include "render/base/contracts.h"
#include "render/base/parallel.h"

namespace gladstone::inline density {
namespace {

/// Returns the matrix of second differences of an even profile that is zero beyond its last radius.
Eigen::MatrixXd make_second_differences(Eigen::Index n) {
  Eigen::MatrixXd difference = Eigen::MatrixXd::Zero(n, n);
  for (Eigen::Index i = 0; i < n; ++i) {
    difference(i, i) -= 2.0;
    difference(i, i == 0 ? 1 : i - 1) += 1.0;
    if (i + 1 < n) difference(i, i + 1) += 1.0;
  }
  return difference;
}

/// Returns the inverse variances as weights; the axis and radii without a measurement have the weight 0.
Eigen::VectorXd make_weights(RadialProfile const& profile) {
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(profile.gradient.size());
  for (Eigen::Index i = 1; i < weights.size(); ++i)
    if (std::isfinite(profile.gradient[i])) weights[i] = 1.0 / (profile.sigma[i] * profile.sigma[i]);
  return weights;
}

/// Quality of the fit to one or several rows with one lambda.
struct FitQuality {
  double chi_square = 0.0;            ///< sum of squares of the weighted residuals
  double effective_parameters = 0.0;  ///< trace of the hat matrix over the measured radii
  double count = 0.0;                 ///< number of measured radii
};

FitQuality evaluate_row(Eigen::MatrixXd const& projection, RadialProfile const& profile, double lambda) {
  Eigen::MatrixXd const inversion = make_regularized_inversion(projection, profile, lambda);
  Eigen::VectorXd const weights = make_weights(profile);
  Eigen::VectorXd const gradient = profile.filled_gradient();
  Eigen::MatrixXd const hat = projection * inversion;
  Eigen::VectorXd const residual = gradient - hat * gradient;
  FitQuality quality{residual.cwiseAbs2().dot(weights), 0.0, 0.0};
  for (Eigen::Index i = 0; i < weights.size(); ++i)
    if (weights[i] > 0.0) {
      quality.effective_parameters += hat(i, i);
      quality.count += 1.0;
    }
  return quality;
}

FitQuality evaluate_fit(Eigen::MatrixXd const& projection, std::span<RadialProfile const> profiles, double lambda) {
  std::vector<FitQuality> rows(profiles.size());
  parallel_for(rows.size(), [&](std::size_t i) { rows[i] = evaluate_row(projection, profiles[i], lambda); });
  FitQuality sum;
  for (FitQuality const& row : rows) {
    sum.chi_square += row.chi_square;
    sum.effective_parameters += row.effective_parameters;
    sum.count += row.count;
  }
  return sum;
}

}  // namespace

Eigen::MatrixXd make_regularized_inversion(Eigen::MatrixXd const& projection, RadialProfile const& profile,
                                           double lambda) {
  GLADSTONE_EXPECTS(lambda > 0.0 && profile.gradient.size() == projection.rows());
  Eigen::Index const n = projection.rows();
  Eigen::VectorXd const weights = make_weights(profile);
  Eigen::MatrixXd const weighted = weights.asDiagonal() * projection;
  Eigen::MatrixXd const difference = make_second_differences(n);
  double const scale = weights.sum() / static_cast<double>((weights.array() > 0.0).count());  // 1 / mean variance
  Eigen::MatrixXd normal = projection.transpose() * weighted;
  normal.noalias() += lambda * scale * (difference.transpose() * difference);
  return normal.ldlt().solve(weighted.transpose());
}

double choose_regularization(Eigen::MatrixXd const& projection, std::span<RadialProfile const> profiles,
                             RegularizationChoice choice) {
  GLADSTONE_EXPECTS(!profiles.empty() && choice != RegularizationChoice::given);
  double low = std::log(1e-4), high = std::log(1e8);
  if (choice == RegularizationChoice::discrepancy) {  // chi^2 increases with lambda
    for (int i = 0; i < 16; ++i) {
      double const middle = 0.5 * (low + high);
      FitQuality const quality = evaluate_fit(projection, profiles, std::exp(middle));
      (quality.chi_square < quality.count ? low : high) = middle;
    }
    return std::exp(0.5 * (low + high));
  }
  double best = low, best_score = 0.0;
  for (int i = 0; i <= 24; ++i) {  // lambda increases by a factor of 3.2 per step
    double const logarithm = low + (high - low) * i / 24;
    FitQuality const quality = evaluate_fit(projection, profiles, std::exp(logarithm));
    double const freedom = 1.0 - quality.effective_parameters / quality.count;
    double const score = quality.chi_square / (freedom * freedom);
    if (i > 0 && score >= best_score) continue;
    best = logarithm;
    best_score = score;
  }
  return std::exp(best);
}

}  // namespace gladstone::inline density
