#pragma once

#include <vector>

#include "render/base/image.h"
#include "render/scene/setup.h"

namespace gladstone {

/// What the cone of light that a dot sends through the stop leaves of Eq. 9 where density is a wave across the axis:
/// the mean of 2 J1(x) / x over the thickness, x = pi D_c(s) / wavelength, each slice with its distance s from the dots
/// as lever and with the cone's diameter there, D_c(s) = (f / N) s / Z_B. For a point in focus and small displacements;
/// it passes through zero first at D_c = 1.22 wavelengths.
/// @param wavelength of the density [m]
double cone_transfer(Setup const& setup, double wavelength);

/// The cone's diameter at the medium's mid-plane, (f / N) Z_D / Z_B [m].
double cone_width(Setup const& setup);

/// Mean square of a periodic plane's density gradient against the wavenumber, in shells a fundamental wide.
struct GradientSpectrum {
  std::vector<double> wavenumber;  ///< energy-weighted mean of each shell [rad / node]
  std::vector<double> energy;      ///< up to a common factor

  /// Wavelength whose wavenumber is the root mean square of the spectrum's: the rms of the gradient over the rms of its
  /// own gradient, times 2 pi [nodes]. It alone sets what a wide plane loses in a narrow cone, 1 - (pi D_c / size)^2
  /// / 8.
  double structure_size() const;
};

/// By a discrete Fourier transform; every node's spacing is the same along both axes. @pre periodic in both directions
GradientSpectrum gradient_spectrum(Image<double> const& plane);

/// How the displacements of rays and of Eq. 9 go together over many dots, both components in one.
struct Agreement {
  double correlation = 0;  ///< sum of e . r over the root of (sum of e . e) (sum of r . r)
  double rms_ratio = 0;    ///< rms of the rays over rms of Eq. 9
};

/// What cone_transfer() makes of a whole spectrum, H(k) being the cone's and the dot's transfer and E(k) the spectrum
/// as Eq. 9 sees it: waves are independent, so rays have a mean square of sum E H^2 where Eq. 9 has sum E, and their
/// product has the mean sum E H. Therefore the ratio is sqrt(sum E H^2 / sum E), the correlation
/// sum E H / sqrt(sum E sum E H^2).
/// A dot of diameter d is one of d Z_A / Z_B at the medium and passes 2 J1(x) / x, x = pi d Z_A / (Z_B wavelength). Off
/// the axis a chief ray crosses stacked planes at an angle theta and averages them by sinc(k theta L / 2), for Eq. 9
/// and rays alike: E(k) is the plane's spectrum times the mean of its square over the view and all directions of waves.
/// @param spacing of the plane's nodes [m]
Agreement predicted_agreement(GradientSpectrum const& spectrum, double spacing, Setup const& setup);

}  // namespace gladstone
