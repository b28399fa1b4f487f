#include "analysis/density/aperture_transfer.h"

#include <cmath>

#include "render/base/gauss_legendre.h"

namespace gladstone::density {

double compute_aperture_transfer(ApertureCone const& cone, double wavenumber) {
  static GaussLegendre const rule(12);
  double sum = 0.0, weights = 0.0;
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    double const s = cone.target_distance + 0.5 * cone.thickness * rule.node[i];
    double const diameter = cone.pupil_diameter * s / (cone.lens_distance + cone.target_distance);
    double const phase = pi * diameter * std::abs(wavenumber);
    double const transfer = phase < 1e-6 ? 1.0 : 2.0 * std::cyl_bessel_j(1.0, phase) / phase;
    sum += rule.weight[i] * s * transfer;
    weights += rule.weight[i] * s;
  }
  return sum / weights;
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
