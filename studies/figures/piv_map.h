#pragma once

#include <string>
#include <vector>

#include "render/scene/setup.h"

namespace gladstone {

/// What a stop makes of the particles of a setup.
struct PivStop {
  double f_number;
  double image_px;           ///< e^-2 diameter of an image in the middle of the sheet [px]
  double edge_px;            ///< and at its edge [px]
  double peak_electrons[3];  ///< at the peak, of which a twentieth, half, and all but a twentieth of the particles have
                             ///< less
};

/// The usual stops from f/1.4 to f/32. @pre setup.piv @throws DataError as expected_particles()
std::vector<PivStop> piv_stops(Setup setup);

/// Draws them over the f-number, with the diameters that suit correlation, the full well, and the setup's own stop:
/// what a stop is chosen by. @throws GnuplotMissing, OutputError
void write_piv_map(std::string const& path, Setup const& setup);

}  // namespace gladstone
