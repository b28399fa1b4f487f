#pragma once

#include <vector>

#include "render/scene/setup.h"
#include "studies/drawing/figure.h"

namespace gladstone::inline figures {

/// Particle images of a setup at one f-number.
struct PivStop {
  double f_number;
  double image_px;           ///< e^-2 diameter of an image in the middle of the sheet [px]
  double edge_px;            ///< e^-2 diameter at the edge of the sheet [px]
  double peak_electrons[3];  ///< 5th percentile, median and 95th percentile of the peak charge [e]
};

/// Computes the particle images at the standard f-numbers from f/1.4 to f/32.
/// @pre setup.piv
/// @throws DataError as expected_particles()
std::vector<PivStop> piv_stops(Setup setup);

/// Draws the quantities of PivStop against the f-number, with the image diameters suitable for correlation, the full
/// well and the setup's f-number.
Figure make_piv_map(Setup const& setup);

}  // namespace gladstone::inline figures
