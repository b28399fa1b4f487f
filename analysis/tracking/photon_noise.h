#pragma once

#include <vector>

namespace gladstone::inline tracking {

/// Residual of a pixel after the fit of an isolated dot.
struct ResidualSample {
  double light = 0;  ///< fitted light of the dot on the pixel [grey levels]
  double flux = 0;   ///< light of the dot on all pixels [grey levels]
  /// Squared residual divided by 1 - h, where h is the leverage of the pixel in the fit [grey levels^2].
  double square = 0;
};

/// Estimates the conversion gain g of a camera [grey levels/e] from the residuals of fitted dots (photon transfer:
/// Janesick, Photon Transfer (2007), ch. 5). Electrons are Poisson distributed, so a pixel with the light L of dots has
/// the variance n0^2 + g L, where n0 is the noise of the background. The fit reduces the variance of a residual by the
/// factor 1 - h. Deviations of dot images from the Gaussian are proportional to the flux F of the dot; they add m^2 F^2
/// to the variance. The parameters g and m are determined together, so that the median of square / variance equals that
/// of chi2 with one degree of freedom, 0.4549, both in the half of the pixels with large L / F^2 and in the half with
/// small L / F^2. Undetected dots hardly affect medians. The gain is zero if it is not significant (four standard
/// errors of the median) or if shot noise is less than a third of the variance in the half with large L / F^2.
/// @param background_noise  noise n0 of the background [grey levels]; pixels with less light than n0 are ignored
/// @return conversion gain; 0 without significant shot noise, or for fewer than 200 pixels. Of more than 20000 pixels,
///         a subset at equal intervals is used
double estimate_conversion_gain(std::vector<ResidualSample> const& samples, double background_noise);

}  // namespace gladstone::inline tracking
