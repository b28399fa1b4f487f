#pragma once

#include <vector>

#include "render/base/image.h"
#include "render/scene/setup.h"

namespace gladstone::inline compare {

/// Returns the aperture-averaged displacement amplitude relative to the small-angle theory (Eq. 9), for a density wave
/// transverse to the axis: the mean of 2 J1(x) / x over the thickness, with x = pi D_c(s) / wavelength, weighted by the
/// distance s of each slice from the dots. The light cone's diameter is D_c(s) = (f / N) s / Z_B. The first zero lies
/// near D_c = 1.22 wavelengths. Assumes a point in focus and small displacements.
/// @param wavelength  of the density wave [m]
double cone_transfer(Setup const& setup, double wavelength);

/// Returns the diameter of the light cone in the medium's mid-plane, (f / N) Z_D / Z_B [m].
double cone_width(Setup const& setup);

/// Power spectrum of a periodic plane's density gradient, in wavenumber shells.
struct GradientSpectrum {
  std::vector<double> wavenumber;  ///< energy-weighted mean of each shell [rad/node]
  std::vector<double> energy;      ///< mean square of the gradient in each shell, up to a common factor

  /// Returns the wavelength of the spectrum's rms wavenumber: 2 pi times the rms of the gradient over the rms of the
  /// gradient's gradient [nodes]. For a narrow light cone it alone determines the loss of amplitude of a wide plane,
  /// (pi D_c / size)^2 / 8.
  double structure_size() const;
};

/// Computes the spectrum by a discrete Fourier transform.
/// @param plane  values at nodes with equal spacing along both axes
/// @pre periodic in both directions
GradientSpectrum gradient_spectrum(Image<double> const& plane);

/// Agreement of ray displacements r with the small-angle theory e (Eq. 9) over many dots and both components.
struct Agreement {
  double correlation = 0;  ///< sum of e . r over the root of (sum of e . e) (sum of r . r) [1]
  double rms_ratio = 0;    ///< rms of the rays over rms of Eq. 9 [1]
};

/// Predicts the agreement from the plane's spectrum. With the transfer H(k) of cone and dot and the spectrum E(k) of
/// Eq. 9, independent waves give the rms ratio sqrt(sum E H^2 / sum E) and the correlation sum E H / sqrt(sum E sum E
/// H^2).
/// - A dot of diameter d has diameter d Z_A / Z_B at the medium and the transfer 2 J1(x) / x, x = pi d Z_A / (Z_B
///   wavelength).
/// - Off the axis, a chief ray crosses stacked planes at an angle theta and averages them by sinc(k theta L / 2), for
///   Eq. 9 and rays alike: E(k) is the plane's spectrum times the mean square of that factor over the view and all wave
///   directions.
/// @param spacing  distance between the plane's nodes [m]
Agreement predicted_agreement(GradientSpectrum const& spectrum, double spacing, Setup const& setup);

}  // namespace gladstone::inline compare
