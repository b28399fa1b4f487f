#pragma once

#include <vector>

#include "render/scene/setup.h"

namespace gladstone {

/// A quantity over the particles of a setup: what a twentieth of them stays below, half, and all but a twentieth.
struct SizeSpread {
  double p05 = 0, median = 0, p95 = 0;
};

/// What a camera makes of particles in the middle of the sheet, where its axis meets it, by closed forms, without
/// medium: what to expect before anything is rendered.
struct ExpectedParticles {
  double magnification = 0;           ///< at the sheet [1]
  double diffraction_px = 0;          ///< e^-2 diameter of the spot [px]
  double image_diameter_px = 0;       ///< e^-2 diameter of the median particle's image in the middle of the sheet [px]
  double sheet_edge_diameter_px = 0;  ///< the same half the sheet's thickness nearer or farther, the wider one [px]
  double depth_of_field = 0;          ///< [m]
  double per_pixel = 0;               ///< particles lit and seen a pixel; NaN: not known of a file [1/px]
  double source_density = 0;          ///< share of the image that their images take: above 0.3 or so they overlap [1]
  SizeSpread diameter;                ///< [m]
  SizeSpread photons;                 ///< through the lens, of a pulse
  SizeSpread peak_electrons;          ///< in the pixel that an image is centred on
  double saturated = 0;               ///< share of particles whose peak exceeds the full well [1]
  double smallest_visible = 0;        ///< diameter from which on all larger ones are seen [m]; NaN: none up to 100 um
};

/// Image of the median particle in the middle of the sheet, where the camera's axis meets it.
struct ParticleImage {
  double distance = 0;        ///< from the front principal plane, along the camera's axis [m]
  double magnification = 0;   ///< there [1]
  double geometric_px = 0;    ///< diameter of the geometric image [px]
  double diffraction_px = 0;  ///< e^-2 diameter of the spot [px]
  double blur_px = 0;         ///< diameter of the disc of confusion [px]

  double diameter_px() const;  ///< e^-2 diameter of the whole image [px]
};
/// @pre setup.piv @throws DataError of a file of diameters
ParticleImage particle_image(Setup const& setup);

/// Image diameter d^2 = (M d_p)^2 + d_diff^2 + d_blur^2 of e^-2 diameters, d_diff = 1.682 N (1 + M) lambda for the
/// Gaussian matched to the Airy pattern, d_blur that of the disc of confusion M D_a |z| / (Z + z) (Adrian & Yao 1985;
/// Olsen & Adrian 2000). Depth of field 4.88 ((M + 1)/M)^2 N^2 lambda (Adrian 1991; Raffel et al. 2018). Particles a
/// window C D^2 dz / M^2, dz the sheet's e^-2 width within the volume (Keane & Adrian 1992), and their source density
/// C dz pi d^2 / (4 M^2) (Adrian 1991). Photons as the renderer has them: fluence times differential cross-section
/// times the solid angle of the entrance pupil. The peak's share of them is a Gaussian's over a pixel of its middle,
/// or the Airy pattern's. Visible is what exceeds its noise, shot noise and read noise together, five times (Rose, J.
/// Opt. Soc. Am. 38 (1948) 196).
/// @pre setup.piv
/// @throws DataError of a file of diameters or particles
ExpectedParticles expected_particles(Setup const& setup);

}  // namespace gladstone
