#pragma once

#include <algorithm>
#include <cmath>

#include "analysis/correlation/axis_weights.h"
#include "analysis/correlation/subpixel_fit.h"
#include "analysis/correlation/window_measurement.h"

namespace gladstone {

/// Measures a peak by any subpixel fit: as measured_peak() does by three points, which is what a GPU has.
/// @param plane a correlation coefficient at a shift (dx, dy)
/// @param x, y  weights along the axes, column and row their window
template <class Plane>
MeasuredPeak fitted_peak(SubpixelFit fit, Plane const& plane, int peak_x, int peak_y, AxisWeightsView const& x,
                         int column, AxisWeightsView const& y, int row) {
  PeakPatch patch;
  for (int j = -1; j <= 1; ++j) {
    double const down = y.autocorrelation(row, 0) / y.autocorrelation(row, peak_y + j);
    for (int i = -1; i <= 1; ++i)
      patch.value[j + 1][i + 1] =
          plane(peak_x + i, peak_y + j) * down * x.autocorrelation(column, 0) / x.autocorrelation(column, peak_x + i);
  }
  PeakFit const peak = fit(patch);
  return {{peak_x + peak.x, peak_y + peak.y}, patch.value[1][1] * std::min(std::exp(peak.log_rise), largest_rise)};
}

/// The same where planes do not fall off with the shift.
template <class Plane>
MeasuredPeak fitted_peak(SubpixelFit fit, Plane const& plane, int peak_x, int peak_y) {
  PeakPatch patch;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) patch.value[j + 1][i + 1] = plane(peak_x + i, peak_y + j);
  PeakFit const peak = fit(patch);
  return {{peak_x + peak.x, peak_y + peak.y}, patch.value[1][1] * std::min(std::exp(peak.log_rise), largest_rise)};
}

}  // namespace gladstone
