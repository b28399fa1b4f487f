#pragma once

#include <vector>

namespace gladstone::tracking {

/// Residual of a pixel after the fit of an isolated dot.
struct ResidualSample {
  double light = 0;   ///< fitted light of the dot on the pixel [grey levels]
  double flux = 0;    ///< light of the dot on all pixels [grey levels]
  double square = 0;  ///< squared residual over 1 - h with the leverage h of the pixel in the fit [grey levels^2]
};

/// Estimates the conversion gain g of a camera [grey levels/e] from the residuals of fitted dots (photon transfer:
/// Janesick, Photon Transfer (2007), ch. 5). Electrons are Poisson distributed, so a pixel with the light L of dots has
/// the variance n0^2 + g L, with n0 the noise of the background; of a residual, the fit leaves the fraction 1 - h.
/// Deviations of dot images from the Gaussian are proportional to the flux F of the dot; they add m^2 F^2, which is
/// fitted too and not part of the result. g and m are such that in each half of the pixels, those with large and those
/// with small L / F^2, the median of square / variance is that of chi2 with one degree of freedom, 0.4549. Undetected
/// dots hardly affect medians. The gain is zero if it is not significant (four standard errors of the median) or if
/// shot noise is less than a third of the variance in the half with large L / F^2.
/// @param background_noise  n0 [grey levels]; pixels with less light than that are ignored
/// @return  0 without shot noise, or with fewer than 200 pixels; of more than 20000 pixels, equidistant ones are used
double estimate_conversion_gain(std::vector<ResidualSample> const& samples, double background_noise);

}  // namespace gladstone::tracking
