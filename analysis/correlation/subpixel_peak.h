#pragma once

#include <cmath>

#include "render/base/host_device.h"

namespace gladstone::inline correlation {

/// Returns the vertex of the parabola through (-1, left), (0, centre), (1, right), clamped to [-1, 1], in sample
/// distances from the centre; 0 if the parabola does not open downwards.
template <class T>
GLADSTONE_HD T parabola_offset(T left, T centre, T right) {
  T const curvature = left - T(2) * centre + right;
  if (!(curvature < T(0))) return T(0);
  T const offset = T(0.5) * (left - right) / curvature;
  return offset < T(-1) ? T(-1) : (offset > T(1) ? T(1) : offset);
}

/// Natural logarithm. Device code in single precision uses the hardware function, with an error of 2^-21: device code
/// uses single precision to rank peaks, and double precision to measure them.
template <class T>
GLADSTONE_HD T fast_log(T x) {
#if defined(__CUDA_ARCH__)
  if constexpr (sizeof(T) == sizeof(float)) return __logf(x);
#endif
  using std::log;
  return log(x);
}

/// Peak position between the samples along one axis.
template <class T>
struct PeakBetweenSamples {
  T offset;    ///< distance from the centre sample [sample distances]
  T log_rise;  ///< logarithm of the peak height over the centre sample [1]
};

/// Three-point Gaussian estimate of a peak between samples: exact for samples of exp(-(s - s0)^2 / (2 sigma^2)).
/// Willert & Gharib, Exp. Fluids 10 (1991) 181. If a sample is not positive, the parabola through the samples is used
/// instead of that through their logarithms.
/// @pre centre > 0, and centre is not lower than left and right (a local maximum); otherwise the offset is within [-1,
/// 1] but has no meaning
template <class T>
GLADSTONE_HD PeakBetweenSamples<T> gaussian_peak(T left, T centre, T right) {
  bool const positive = left > T(0) && centre > T(0) && right > T(0);
  T const l = positive ? fast_log(left / centre) : left / centre,
          r = positive ? fast_log(right / centre) : right / centre;
  T const c = positive ? T(0) : T(1), offset = parabola_offset(l, c, r);
  T const rise = T(0.5) * offset * ((r - l) + (l - T(2) * c + r) * offset);
  return {offset, positive ? rise : fast_log(c + rise)};
}

}  // namespace gladstone::inline correlation
