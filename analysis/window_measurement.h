#pragma once

#include <array>
#include <cmath>

#include "analysis/axis_weights.h"
#include "analysis/subpixel_peak.h"
#include "analysis/window_ops.h"
#include "render/base/host_device.h"
#include "render/base/vec.h"

/// What is read from one window and its correlation plane: the same functions serve the CPU and a CUDA kernel.
namespace gladstone {

enum class Axis { x, y };

/// What the correlation of one window gave.
struct WindowCorrelation {
  enum class Outcome { measured, no_signal, masked };
  Outcome outcome = Outcome::no_signal;
  int peaks = 0;                 ///< candidates found, at most 3
  std::array<Vec2d, 3> shift{};  ///< subpixel positions of the highest peaks, highest first [px]
  double peak_ratio = 0.0;       ///< height of the highest over the second highest peak, at most 1000
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

/// Where a peak lies between the pixels along one axis, by three points; the fall-off of the plane with the shift that
/// the weights cause is divided out before. @param plane value at a shift (dx, dy) @param weights along that axis
template <class Plane>
GLADSTONE_HD double refined_shift(Plane const& plane, PlanePeak<float> const& peak, Axis axis,
                                  AxisWeightsView const& weights, int window) {
  int const step_x = axis == Axis::x, step_y = axis == Axis::y, whole = axis == Axis::x ? peak.x : peak.y;
  double along[3];
  for (int d = -1; d <= 1; ++d)
    along[d + 1] = plane(peak.x + d * step_x, peak.y + d * step_y) / weights.autocorrelation(window, whole + d);
  return whole + gaussian_peak_offset(along[0], along[1], along[2]);
}

/// Height of the highest over that of the second highest peak. @param second 0 where there is none
GLADSTONE_HD inline double peak_ratio(double highest, double second) {
  double const ratio = highest / (second > 1e-12 ? second : 1e-12);
  return ratio < largest_peak_ratio ? ratio : largest_peak_ratio;
}

}  // namespace gladstone
