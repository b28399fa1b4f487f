#pragma once

namespace gladstone {

/// Random error of a displacement that our correlator measures, per component [px], for images of dots of Gaussian spots
/// that move together: what the dots' places change and what noise changes, in quadrature, sigma^2 = (pattern^2 +
/// noise^2) (20 / N_I) with
///
///   pattern = 0.0014 + 0.21 exp(-2.1 d)         noise = 0.083 q d^0.6
///
/// Fitted to data/estimators/random_error.csv. Its range is random_error_range; strains up to 0.02 change nothing
/// (docs/estimators.md: shear and uniform shifts have the same error after several passes).
template <class T>
T random_error_px(T diameter_px, T noise, double dots_in_window);

}  // namespace gladstone
