#pragma once

#include <array>
#include <cmath>

#include "analysis/correlation/peak_search.h"
#include "analysis/correlation/window_ops.h"
#include "render/base/host_device.h"
#include "render/base/vec.h"

/// Results of one window, and functions that evaluate its correlation plane, shared by the CPU and the CUDA kernels.
namespace gladstone::inline correlation {

/// Result of the correlation of one window.
struct WindowCorrelation {
  enum class Outcome { measured, no_signal, masked, no_peak };  ///< no_peak: no peak within the search range
  Outcome outcome = Outcome::no_signal;
  int peaks = 0;                 ///< number of peaks found, at most 3, in the order of PeakList
  std::array<Vec2d, 3> shift{};  ///< subpixel positions of the peaks [px]
  /// Peak heights as correlation coefficients of the region where the shifted windows overlap [1]. They are corrected
  /// for the decrease of the plane with the shift, so that the aliases of a periodic pattern have equal heights. In
  /// perfectly matching windows they are 1 apart from noise and interpolation error.
  std::array<double, 3> coefficient{};
  double peak_ratio = 0.0;  ///< height of the first peak over the higher of the other peaks, at most 1000 [1]
};

constexpr double largest_peak_ratio = 1000.0;
/// Minimum contrast of a window with a signal: ratio of the weighted rms of the window to the grey-level range of the
/// image pair. Lower values are rounding errors.
constexpr double smallest_contrast = 1e-6;
/// Minimum fraction of a window's weight that must be on known pixels: one half, with a margin for rounding.
constexpr double min_valid_weight_fraction = 0.5 - 1e-5;

/// Returns the factor that converts a plane of unnormalised transforms of size^2 values to correlation coefficients; 0
/// if the nominal window has no signal in one of the images.
/// @param contrast  grey-level range of the image pair, in the units of the energies
GLADSTONE_HD inline double plane_scale(WindowEnergy const& energy, float contrast, int window_px, int size) {
  using std::sqrt;
  double const least = smallest_contrast * contrast;
  double const faint = least * least * window_px * window_px;
  if (!(energy.core_reference > faint && energy.core_flow > faint)) return 0.0;
  return 1.0 / (sqrt(static_cast<double>(energy.reference) * energy.flow) * size * size);
}

/// Position and height of a peak.
struct MeasuredPeak {
  Vec2d shift;         ///< position [px]
  double coefficient;  ///< height of the peak as a correlation coefficient, see WindowCorrelation [1]
};

/// Returns the height of the first peak over that of the higher of the other two, at most largest_peak_ratio.
/// @param second,  third  heights of the other peaks; 0: none
GLADSTONE_HD inline double peak_ratio(double first, double second, double third) {
  double const other = second > third ? second : third;
  double const ratio = first / (other > 1e-12 ? other : 1e-12);
  return ratio < largest_peak_ratio ? ratio : largest_peak_ratio;
}

}  // namespace gladstone::inline correlation
