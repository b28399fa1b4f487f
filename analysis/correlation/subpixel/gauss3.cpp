#include "analysis/correlation/subpixel_fit.h"
#include "analysis/correlation/subpixel_peak.h"

namespace gladstone {

PeakFit fit_gauss3(PeakPatch const& patch) {
  auto const& v = patch.value;
  PeakBetweenSamples<double> const across = gaussian_peak(v[1][0], v[1][1], v[1][2]);
  PeakBetweenSamples<double> const down = gaussian_peak(v[0][1], v[1][1], v[2][1]);
  return {across.offset, down.offset, across.log_rise + down.log_rise};
}

}  // namespace gladstone
