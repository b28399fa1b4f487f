#pragma once

#include <cmath>

#include "analysis/correlation/axis_weights.h"
#include "analysis/correlation/subpixel_fit.h"
#include "analysis/correlation/window_measurement.h"

namespace gladstone {

/// What a fit makes of a peak whose highest sample is `height`.
GLADSTONE_HD inline MeasuredPeak peak_of(PeakFit const& fit, int peak_x, int peak_y, double height) {
  double const rise = std::exp(fit.log_rise);
  return {{peak_x + fit.x, peak_y + fit.y}, height * (rise < largest_rise ? rise : largest_rise)};
}

/// Measures a peak by any subpixel fit, as measured_peak() does by three points.
/// @param plane a correlation coefficient at a shift (dx, dy)
/// @param x, y  weights along the axes, column and row their window
template <class Fit, class Plane>
GLADSTONE_HD MeasuredPeak fitted_peak(Fit const& fit, Plane const& plane, int peak_x, int peak_y,
                                      AxisWeightsView const& x, int column, AxisWeightsView const& y, int row) {
  PeakPatch patch;
  for (int j = -1; j <= 1; ++j) {
    double const down = y.autocorrelation(row, 0) / y.autocorrelation(row, peak_y + j);
    for (int i = -1; i <= 1; ++i)
      patch.value[j + 1][i + 1] =
          plane(peak_x + i, peak_y + j) * down * x.autocorrelation(column, 0) / x.autocorrelation(column, peak_x + i);
  }
  return peak_of(fit(patch), peak_x, peak_y, patch.value[1][1]);
}

/// The same where planes do not fall off with the shift.
template <class Fit, class Plane>
GLADSTONE_HD MeasuredPeak fitted_peak(Fit const& fit, Plane const& plane, int peak_x, int peak_y) {
  PeakPatch patch;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) patch.value[j + 1][i + 1] = plane(peak_x + i, peak_y + j);
  return peak_of(fit(patch), peak_x, peak_y, patch.value[1][1]);
}

}  // namespace gladstone
