#pragma once

#include <array>
#include <cmath>

#include "analysis/correlation/axis_weights.h"
#include "analysis/correlation/peak_search.h"
#include "analysis/correlation/subpixel_peak.h"
#include "analysis/correlation/window_ops.h"
#include "render/base/host_device.h"
#include "render/base/vec.h"

/// What is read from one window and its correlation plane: the same functions serve the CPU and a CUDA kernel.
namespace gladstone {

/// What the correlation of one window gave.
struct WindowCorrelation {
  enum class Outcome { measured, no_signal, masked, no_peak };  ///< no_peak: none within the search range
  Outcome outcome = Outcome::no_signal;
  int peaks = 0;                 ///< candidates found, at most 3, in the order of PeakList
  std::array<Vec2d, 3> shift{};  ///< their positions between the pixels [px]
  /// Their heights as correlation coefficients of what the shifted windows have in common [1]: the fall-off of the
  /// plane with the shift is divided out, so that aliases of a pattern come out alike; 1 but for noise and
  /// interpolation.
  std::array<double, 3> coefficient{};
  double peak_ratio = 0.0;  ///< height of the first over the higher of the others in the plane, at most 1000
};

constexpr double largest_peak_ratio = 1000.0;
/// Contrast (weighted rms over that of the whole image) below which a window is rounding, not signal.
constexpr double smallest_contrast = 1e-6;
/// Part of a window's weight that must be on known pixels: half, less what rounding may take.
constexpr double smallest_known_part = 0.5 - 1e-5;

/// The factor that makes a plane of unnormalised transforms of size^2 values a correlation coefficient; 0 where the
/// nominal window holds no signal in one of the images.
/// @param contrast of the whole image, in the grey levels of the energies
GLADSTONE_HD inline double plane_scale(WindowEnergy<float> const& energy, float contrast, int window_px, int size) {
  using std::sqrt;
  double const least = smallest_contrast * contrast;
  double const faint = least * least * window_px * window_px;
  if (!(energy.core_reference > faint && energy.core_flow > faint)) return 0.0;
  return 1.0 / (sqrt(static_cast<double>(energy.reference) * energy.flow) * size * size);
}

/// A peak's place and height.
struct MeasuredPeak {
  Vec2d shift;         ///< [px]
  double coefficient;  ///< as in WindowCorrelation [1]
};

/// Measures a peak by three points along each axis; the fall-off of the plane with the shift that the weights cause is
/// divided out before, else it would pull every peak towards zero.
/// @param plane value at a shift (dx, dy) @param scale makes the plane a correlation coefficient
/// @param x, y  weights along the axes, column and row their window
template <class Plane>
GLADSTONE_HD MeasuredPeak measured_peak(Plane const& plane, int peak_x, int peak_y, double scale,
                                        AxisWeightsView const& x, int column, AxisWeightsView const& y, int row) {
  using std::exp;
  double across[3], down[3];
  for (int d = -1; d <= 1; ++d) {
    across[d + 1] = plane(peak_x + d, peak_y) / x.autocorrelation(column, peak_x + d);
    down[d + 1] = plane(peak_x, peak_y + d) / y.autocorrelation(row, peak_y + d);
  }
  PeakBetweenSamples<double> const along_x = gaussian_peak(across[0], across[1], across[2]);
  PeakBetweenSamples<double> const along_y = gaussian_peak(down[0], down[1], down[2]);
  double const fall_off = x.autocorrelation(column, peak_x) * y.autocorrelation(row, peak_y) /
                          (x.autocorrelation(column, 0) * y.autocorrelation(row, 0));
  double const rise = exp(along_x.log_rise + along_y.log_rise);
  return {{peak_x + along_x.offset, peak_y + along_y.offset},
          scale * plane(peak_x, peak_y) * (rise < largest_rise ? rise : largest_rise) / fall_off};
}

/// Height of the first over the higher one of the other peaks. @param second, third 0 where there is none
GLADSTONE_HD inline double peak_ratio(double first, double second, double third) {
  double const other = second > third ? second : third;
  double const ratio = first / (other > 1e-12 ? other : 1e-12);
  return ratio < largest_peak_ratio ? ratio : largest_peak_ratio;
}

}  // namespace gladstone
