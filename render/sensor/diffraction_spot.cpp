#include "render/sensor/diffraction_spot.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "render/base/image.h"
#include "render/base/units.h"

namespace gladstone::inline sensor {
namespace {

/// Returns the irradiance of the Airy pattern relative to its peak (Born & Wolf, section 8.5.2).
/// @param r  radius in units of N (1 + M) lambda
double airy(double r) {
  double const v = pi * r;
  if (v < 1e-4) return 1 - v * v / 4;
  double const amplitude = 2 * std::cyl_bessel_j(1.0, v) / v;
  return amplitude * amplitude;
}

/// Summed-area table of the Airy pattern, sampled at `fine` midpoints per pixel and axis.
class IntegralLattice {
 public:
  IntegralLattice(double scale_px, int fine, int reach) : sums_(2 * reach + 1, 2 * reach + 1, 0.0), reach_(reach) {
    double const cut = static_cast<double>(reach) / fine - 1.0;
    for (int b = -reach; b < reach; ++b) {
      double row = 0;
      for (int a = -reach; a < reach; ++a) {
        double const r = std::hypot(a + 0.5, b + 0.5) / fine;
        if (r <= cut) row += airy(r / scale_px);
        sums_(a + 1 + reach, b + 1 + reach) = sums_(a + 1 + reach, b + reach) + row;
      }
    }
  }
  /// Returns the sum over cells [a, a + count) x [b, b + count).
  double square(int a, int b, int count) const {
    auto const at = [&](int i, int j) { return sums_(i + reach_, j + reach_); };
    return at(a + count, b + count) - at(a, b + count) - at(a + count, b) + at(a, b);
  }

 private:
  Image<double> sums_;
  int reach_;
};

}  // namespace

AiryTable::AiryTable(double scale_px)
    : subdivisions_(2 * std::clamp(static_cast<int>(std::ceil(20 / scale_px)), 8, 64)),
      half_width_(std::max(3, static_cast<int>(std::ceil(6 * scale_px)))) {
  int const fine = subdivisions_;
  int const width = 2 * half_width_ + 1;
  IntegralLattice const lattice(scale_px, fine, (half_width_ + 2) * fine);
  auto const footprint = static_cast<std::size_t>(width) * static_cast<std::size_t>(width);
  shares_.resize(static_cast<std::size_t>(fine + 1) * static_cast<std::size_t>(fine + 1) * footprint);
  double* out = shares_.data();
  for (int sub_y = 0; sub_y <= fine; ++sub_y) {
    for (int sub_x = 0; sub_x <= fine; ++sub_x) {
      // The PSF is centred at (sub / fine - 1/2) from the centre of the middle pixel.
      double total = 0;
      double* const begin = out;
      for (int j = -half_width_; j <= half_width_; ++j) {
        for (int i = -half_width_; i <= half_width_; ++i) {
          *out = lattice.square(i * fine - sub_x, j * fine - sub_y, fine);
          total += *out++;
        }
      }
      std::for_each(begin, out, [total](double& share) { share /= total; });
    }
  }
}

}  // namespace gladstone::inline sensor
