#pragma once

#include <cmath>

#include "analysis/correlation/axis_weights.h"
#include "analysis/correlation/subpixel_fit.h"
#include "analysis/correlation/window_measurement.h"

namespace gladstone::inline correlation {

/// Converts a subpixel fit to a peak position and height. @param height  value of the peak's highest sample
GLADSTONE_HD inline MeasuredPeak to_measured_peak(PeakFit const& fit, int peak_x, int peak_y, double height) {
  double const rise = std::exp(fit.log_rise);
  return {{peak_x + fit.x, peak_y + fit.y}, height * (rise < largest_rise ? rise : largest_rise)};
}

/// Measures a peak by a subpixel fit. The plane is first divided by the factor by which the weights reduce it with
/// increasing shift, because this decrease biases every peak towards zero.
/// @param plane  correlation coefficient at a shift (dx, dy)
/// @param x,  y  window weights along the axes
/// @param column,  row  position of the window in the grid
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
  return to_measured_peak(fit(patch), peak_x, peak_y, patch.value[1][1]);
}

/// Measures a peak by a subpixel fit, for planes that do not decrease with the shift.
template <class Fit, class Plane>
GLADSTONE_HD MeasuredPeak fitted_peak(Fit const& fit, Plane const& plane, int peak_x, int peak_y) {
  PeakPatch patch;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i) patch.value[j + 1][i + 1] = plane(peak_x + i, peak_y + j);
  return to_measured_peak(fit(patch), peak_x, peak_y, patch.value[1][1]);
}

}  // namespace gladstone::inline correlation
