#include <algorithm>

#include "analysis/correlation/subpixel_fit.h"

namespace gladstone::inline correlation {

PeakFit fit_centroid(PeakPatch const& patch) {
  auto const& v = patch.value;
  auto const centre_of_mass = [&](double left, double right) {
    left = std::max(left, 0.0);
    right = std::max(right, 0.0);
    return (right - left) / (left + v[1][1] + right);
  };
  // A centre of mass yields no peak height; use the height of the Gaussian fit.
  return {centre_of_mass(v[1][0], v[1][2]), centre_of_mass(v[0][1], v[2][1]), fit_gauss3(patch).log_rise};
}

}  // namespace gladstone::inline correlation
