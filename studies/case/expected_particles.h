#pragma once

#include "render/scene/setup.h"

namespace gladstone::inline cases {

/// Distribution of a quantity over the particles of a setup: 5th percentile, median and 95th percentile.
struct SizeSpread {
  double p05 = 0, median = 0, p95 = 0;
};

/// Expected images of particles in the middle of the laser sheet, where the camera's axis intersects it, from closed
/// forms without a medium.
struct ExpectedParticles {
  double magnification = 0;      ///< magnification at the sheet [1]
  double diffraction_px = 0;     ///< e^-2 diameter of the diffraction-limited PSF [px]
  double image_diameter_px = 0;  ///< e^-2 diameter of the median particle's image in the middle of the sheet [px]
  /// larger of the e^-2 image diameters at half the sheet's thickness in front of and behind its middle [px]
  double sheet_edge_diameter_px = 0;
  double depth_of_field = 0;  ///< depth of field [m]
  /// illuminated and visible particles per pixel; NaN: unknown, for particles from a file [1/px]
  double per_pixel = 0;
  /// fraction of the image covered by particle images; above about 0.3 they overlap [1]
  double source_density = 0;
  SizeSpread diameter;        ///< particle diameters [m]
  SizeSpread photons;         ///< photons through the lens per pulse
  SizeSpread peak_electrons;  ///< charge of the pixel on which an image is centred [e]
  double saturated = 0;       ///< fraction of particles whose peak exceeds the full well [1]
  /// smallest diameter above which all particles are visible [m]; NaN: none up to 100 um
  double smallest_visible = 0;
};

/// Image of the median particle in the middle of the sheet, where the camera's axis meets it.
struct ExpectedParticleImage {
  double distance = 0;        ///< distance from the front principal plane, along the camera's axis [m]
  double magnification = 0;   ///< magnification at this distance [1]
  double geometric_px = 0;    ///< diameter of the geometric image [px]
  double diffraction_px = 0;  ///< e^-2 diameter of the diffraction-limited PSF [px]
  double blur_px = 0;         ///< diameter of the circle of confusion [px]

  double diameter_px() const;  ///< returns the e^-2 diameter of the total image [px]
};
/// Returns the image of the median particle of a PIV setup.
/// @pre setup.piv
/// @throws DataError for an invalid file of diameters
ExpectedParticleImage particle_image(Setup const& setup);

/// Computes the expected particle images.
/// - Diameter d^2 = (M d_p)^2 + d_diff^2 + d_blur^2 in e^-2 diameters, with d_diff = 1.682 N (1 + M) lambda for the
///   Gaussian matched to the Airy pattern and d_blur from the circle of confusion M D_a |z| / (Z + z) (Adrian & Yao
///   1985; Olsen & Adrian 2000). Depth of field 4.88 ((M + 1)/M)^2 N^2 lambda (Adrian 1991; Raffel et al. 2018).
/// - Particles per interrogation window C D^2 dz / M^2, dz the sheet's e^-2 width within the volume (Keane & Adrian
///   1992); source density C dz pi d^2 / (4 M^2) (Adrian 1991).
/// - Photons as in the renderer: fluence times differential cross-section times solid angle of the entrance pupil. The
///   peak pixel's share is that of a centred Gaussian or Airy pattern.
/// - A particle is visible if its peak exceeds five times the combined shot, dark and read noise (Rose, J. Opt. Soc.
///   Am. 38 (1948) 196).
/// @pre setup.piv
/// @throws DataError for an invalid file of diameters or particles
ExpectedParticles expected_particles(Setup const& setup);

}  // namespace gladstone::inline cases
