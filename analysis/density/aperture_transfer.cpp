#include "analysis/density/aperture_transfer.h"

#include <cmath>

#include "analysis/density/disc_transfer.h"

namespace gladstone::density {

double compute_aperture_transfer(ApertureCone const& cone, double wavenumber) {
  if (wavenumber == 0.0) return 1.0;
  return cone_transfer(cone.pupil_diameter, cone.lens_distance + cone.target_distance, cone.target_distance,
                       cone.thickness, 1.0 / std::abs(wavenumber));
}

double find_resolved_wavelength(ApertureCone const& cone, double wiener_parameter) {
  auto const response = [&](double wavenumber) {
    double const h = compute_aperture_transfer(cone, wavenumber);
    if (std::isinf(wiener_parameter)) return h;
    return h * h * (1.0 + wiener_parameter) / (h * h + wiener_parameter);
  };
  // The response decreases up to the first zero of the transfer function
  double low = 0.0, high = 1.22 / cone.diameter();
  for (int i = 0; i < 60; ++i) {
    double const middle = 0.5 * (low + high);
    (response(middle) > std::sqrt(0.5) ? low : high) = middle;
  }
  return 1.0 / low;
}

}  // namespace gladstone::density
