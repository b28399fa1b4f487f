#pragma once

#include <cmath>

#include "render/base/host_device.h"

namespace gladstone {

/// Vertex of the parabola through (-1, left), (0, centre), (1, right), in sample distances from the centre; 0 where the
/// three do not curve downwards. Kept within [-1, 1].
template <class T>
GLADSTONE_HD T parabola_offset(T left, T centre, T right) {
  T const curvature = left - T(2) * centre + right;
  if (!(curvature < T(0))) return T(0);
  T const offset = T(0.5) * (left - right) / curvature;
  return offset < T(-1) ? T(-1) : (offset > T(1) ? T(1) : offset);
}

/// Natural logarithm. On a device in single precision it is the hardware's, good to 2^-21: peaks are ranked by it, and
/// measured in double.
template <class T>
GLADSTONE_HD T fast_log(T x) {
#if defined(__CUDA_ARCH__)
  if constexpr (sizeof(T) == sizeof(float)) return __logf(x);
#endif
  using std::log;
  return log(x);
}

/// A peak between samples along one axis.
template <class T>
struct PeakBetweenSamples {
  T offset;    ///< from the centre [sample distances]
  T log_rise;  ///< logarithm of the height there over the centre sample [1]
};

/// Three-point Gaussian estimate of a peak between samples: exact for samples of exp(-(s - s0)^2 / (2 sigma^2)).
/// Willert & Gharib, Exp. Fluids 10 (1991) 181. Where a neighbour is not positive there is no logarithm, and the
/// parabola through the samples stands in.
/// @pre centre > 0, not below left and right (a local maximum), else the offset is within [-1, 1] but means little
template <class T>
GLADSTONE_HD PeakBetweenSamples<T> gaussian_peak(T left, T centre, T right) {
  bool const positive = left > T(0) && centre > T(0) && right > T(0);
  T const l = positive ? fast_log(left / centre) : left / centre,
          r = positive ? fast_log(right / centre) : right / centre;
  T const c = positive ? T(0) : T(1), offset = parabola_offset(l, c, r);
  T const rise = T(0.5) * offset * ((r - l) + (l - T(2) * c + r) * offset);
  return {offset, positive ? rise : fast_log(c + rise)};
}

}  // namespace gladstone
