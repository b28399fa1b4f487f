#include <cmath>

#include "analysis/correlation/subpixel_fit.h"
#include "analysis/correlation/subpixel_peak.h"

namespace gladstone::inline correlation {

PeakFit fit_parabola(PeakPatch const& patch) {
  auto const& v = patch.value;
  auto const rise = [&](double left, double right, double offset) {
    return 0.5 * offset * ((right - left) + (left - 2.0 * v[1][1] + right) * offset);
  };
  double const x = parabola_offset(v[1][0], v[1][1], v[1][2]), y = parabola_offset(v[0][1], v[1][1], v[2][1]);
  double const height = v[1][1] + rise(v[1][0], v[1][2], x) + rise(v[0][1], v[2][1], y);
  return {x, y, std::log(height / v[1][1])};
}

}  // namespace gladstone::inline correlation
