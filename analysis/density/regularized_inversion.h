#pragma once

#include <Eigen/Core>
#include <span>

#include "analysis/density/radial_profile.h"

namespace gladstone::inline density {

/// Tikhonov-regularised Abel inversion: minimises
///   sum_i ((g_i - (F f)_i) / sigma_i)^2 + lambda sum_i (f_i-1 - 2 f_i + f_i+1)^2 / mean(sigma^2)
/// with the operator F of make_gradient_projection(). The profile f is even about the axis and zero beyond the last
/// radius. Radii without a measurement have no weight; their density follows from the smoothness term. The result is
/// linear in g. (Tikhonov & Arsenin, Solutions of Ill-Posed Problems, 1977; for Abel inversion Daun et al., Appl. Opt.
/// 45 (2006) 4638.)
/// @param projection  operator F [n, n]
/// @param lambda      weight of the smoothness, above 0 [1]
/// @return operator R [n, n] with f = R g, where g is 0 at radii without a measurement
Eigen::MatrixXd make_regularized_inversion(Eigen::MatrixXd const& projection, RadialProfile const& profile,
                                           double lambda);

/// Rules for the regularisation parameter.
enum class RegularizationChoice {
  given,            ///< value given by the user
  discrepancy,      ///< the residuals equal the uncertainties: chi^2 = number of data (Morozov 1966); requires sigma
  cross_validation  ///< generalised cross-validation (Golub, Heath & Wahba, Technometrics 21 (1979) 215)
};

/// Determines lambda from profiles by the discrepancy principle or by cross-validation, between 1e-4 and 1e8. Both
/// assume independent errors: for overlapping windows cross-validation regularises too little. The discrepancy
/// principle tends to smooth too much.
/// @param profiles  profiles of at least one row
double choose_regularization(Eigen::MatrixXd const& projection, std::span<RadialProfile const> profiles,
                             RegularizationChoice choice);

}  // namespace gladstone::inline density
