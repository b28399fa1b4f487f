#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "analysis/density/density_integrator.h"
#include "analysis/density/window_correlation.h"

namespace gladstone::inline density {

struct PropagationSettings {
  /// Largest number of unknown nodes up to which the uncertainty is computed exactly.
  std::size_t exact_limit = 4'000;
  std::size_t samples = 400;  ///< number of random samples if there are more unknown nodes than `exact_limit`
  std::uint64_t seed = 1;
};

/// Standard uncertainty of an integrated density.
struct DensityUncertainty {
  std::vector<double> sigma;    ///< standard uncertainty, in the unit of the density [grid.size()]; NaN: not determined
  std::size_t samples = 0;      ///< number of random samples; 0: exact
  double relative_error = 0.0;  ///< standard error of sigma relative to sigma, 1/sqrt(2 samples) [1]; 0: exact
};

/// Linear map of density errors [grid.size()] that is applied after the integration, e.g. a deconvolution.
using DensityFilter = std::function<std::vector<double>(std::span<double const>)>;

/// Propagates the covariance of the vectors to the density: the diagonal of P C P^T, where P = N^-1 A^T W B is the
/// matrix of the integration and C_ij = sigma_i sigma_j r_ij is the covariance of the gradients, with the correlations
/// r of WindowCorrelation. Linear propagation as in Rajendran, Zhang, Bhattacharya, Bane & Vlachos, Meas. Sci. Technol.
/// 31 (2020) 054002, whose code assumes independent vectors. Up to `exact_limit` nodes each row of P is computed; for
/// larger grids, and with a filter, the diagonal is estimated from random errors with covariance C, and the result
/// contains its standard error. The common uncertainty of the reference density is added in quadrature: this
/// uncertainty shifts each region as a whole.
/// @param sigma  standard uncertainty of the gradient, in the unit of the gradient [grid.size()], positive at valid
///              nodes
/// @param reference_sigma  common standard uncertainty of the reference density, in the unit of the density; see
///                        ReferenceDensity::sigma
/// @throws SetupError  if the overlap does not fit the grid, or there are no samples
/// @throws DataError   if sigma is empty: the vectors have no uncertainty
DensityUncertainty propagate_uncertainty(DensityIntegrator const& integrator, std::span<Vec2d const> sigma,
                                         WindowOverlap overlap, double reference_sigma = 0.0,
                                         PropagationSettings const& settings = {}, DensityFilter const& filter = {});

/// Draws one random error of the gradient, with the covariance C defined at propagate_uncertainty().
/// @param sample  index of the sample; samples with different seed or index are independent
/// @return error of the gradient at every node, in the unit of sigma [sigma.size()]
std::vector<Vec2d> draw_gradient_error(WindowCorrelation const& correlation, std::span<Vec2d const> sigma,
                                       std::uint64_t seed, std::uint64_t sample);

/// Adds the uncertainty of the density scale, which is common to the whole field, in quadrature: `relative` times
/// |density - reference|. The scale is the product of the factors of Eq. 9; its relative uncertainty is the root of the
/// sum of the factors' squared relative uncertainties.
/// @param sigma,density  standard uncertainty and density [n], NaN: not determined
/// @param reference      density of the ambient medium, unit of `density`
/// @param relative       relative standard uncertainty of the scale [1]
/// @return               combined standard uncertainty [n]
std::vector<double> add_scale_uncertainty(std::vector<double> sigma, std::span<double const> density, double reference,
                                          double relative);

}  // namespace gladstone::inline density
