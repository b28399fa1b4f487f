#include "analysis/density/aperture_transfer.h"

#include <cmath>

#include "analysis/density/disc_transfer.h"

namespace gladstone::inline density {

double compute_aperture_transfer(ApertureCone const& cone, double wavenumber) {
  if (wavenumber == 0.0) return 1.0;
  return cone_transfer(cone.pupil_diameter, cone.lens_distance + cone.target_distance, cone.target_distance,
                       cone.thickness, 1.0 / std::abs(wavenumber));
}

}  // namespace gladstone::inline density
