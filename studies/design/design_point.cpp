#include "studies/design/design_point.h"

namespace gladstone::inline design {

double resolved_wavelength(DesignPoint<double> const& bench) {
  // Initial guess: a Gaussian with the same curvature at long waves, 1 - (2 pi sigma / wavelength)^2 / 2; the sigma of
  // a disc is a quarter of its diameter.
  double const cone = bench.cone_diameter(), dot = bench.dot_diameter * bench.z_a / bench.z_b();
  double const pixel = bench.pixel_at_medium();
  double const sigma = std::sqrt(bench.given->window.variance() * pixel * pixel + (cone * cone + dot * dot) / 16);
  double low = 2 * pi * sigma, high = low;
  while (bench.transfer(high) < transfer_at_resolution) high *= 1.5;
  while (bench.transfer(low) > transfer_at_resolution) low /= 1.5;
  // Bisection from `high` to the first crossing; shorter waves are assumed not to exceed the threshold again.
  while (high - low > 1e-13 * high) {
    double const middle = 0.5 * (low + high);
    (bench.transfer(middle) < transfer_at_resolution ? low : high) = middle;
  }
  return high;
}

}  // namespace gladstone::inline design
