#pragma once

#include <array>
#include <limits>
#include <span>
#include <vector>

#include "analysis/tracking/gaussian_dot.h"

namespace gladstone::inline tracking {

/// Pixel of a joint fit.
struct FitPixel {
  int column = 0, row = 0;
  double level = 0;      ///< level above the estimated background, positive for light of dots [grey levels]
  double per_sigma = 1;  ///< reciprocal of the noise's standard deviation [1/grey level]
};

/// Returns the smallest rectangle that contains all pixels. @pre there are pixels
PixelBox bounding_box(std::span<FitPixel const> pixels);

/// Distribution of shape and flux over the dots of a frame, and their common profile.
struct DotPrior {
  std::array<double, 3> mean{1, 0, 1};   ///< mean of the shape parameters xx, or xx, xy and yy [px^2]
  std::array<double, 3> sigma{1, 1, 1};  ///< standard deviations of the shape parameters [px^2]
  double flux_mean = 0;                  ///< mean of the flux [grey levels]
  double flux_sigma = 0;                 ///< standard deviation of the flux [grey levels]; 0: no prior
  DotProfile profile;
};

/// Dots fitted together.
struct DotFit {
  std::vector<GaussianDot> dots;
  std::vector<Vec2d> sigma;        ///< standard uncertainty of the centres, from the Fisher information [px]
  std::vector<double> flux_sigma;  ///< standard uncertainty of the fluxes [grey levels]
  double background = 0;           ///< fitted constant that is added to the estimated background [grey levels]
  double cost = 0;                 ///< minimised sum of squares: chi2 plus the squared deviations from the prior [1]
  double chi2 = 0;                 ///< sum of the squared residuals divided by the variance of the noise [1]
  int freedom = 0;                 ///< number of pixels minus number of parameters without a prior
  std::vector<double> residual;    ///< residual of every pixel, measured minus fitted [grey levels]
  /// Leverage of every pixel: derivative of the pixel's fitted level with respect to its measured level, 0 to 1 [1];
  /// empty if several dots are fitted.
  std::vector<double> leverage;
};

/// Fits dots with the profile of the prior, and a constant background, to pixels by weighted least squares
/// (Levenberg-Marquardt). For normal noise this is the maximum-likelihood estimate, whose covariance is the inverse of
/// the Fisher information (Cramer-Rao bound). Shape and flux are constrained by their distribution over the frame,
/// which hardly affects the centres of isolated dots and separates overlapping ones: the shape by a normal prior, the
/// flux by Student's t distribution with four degrees of freedom, so that the fit of a dot with unusual brightness is
/// not distorted.
/// @param start  initial estimates of the dots; one for each dot to be fitted
/// @param most_cost  limit of the cost; a fit whose cost is not expected to fall below this limit is aborted
/// @return dots in the order of start; infinite cost and no uncertainties if the pixels do not determine them or the
///         cost is above most_cost
/// @pre `pixels` is not empty and dots; start values have positive definite second moments
DotFit fit_dots(std::span<FitPixel const> pixels, std::span<GaussianDot const> start, DotShape shape,
                DotPrior const& prior, double most_cost = std::numeric_limits<double>::infinity());

}  // namespace gladstone::inline tracking
