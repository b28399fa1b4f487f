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

/// Three-point Gaussian estimate of a peak between samples, in sample distances from the centre: exact for samples of
/// exp(-(s - s0)^2 / (2 sigma^2)). Willert & Gharib, Exp. Fluids 10 (1991) 181. Where a sample is not positive there is
/// no logarithm, and the parabola through the samples stands in.
/// @pre centre is not below left and right (a local maximum), else the result is within [-1, 1] but means little
template <class T>
GLADSTONE_HD T gaussian_peak_offset(T left, T centre, T right) {
  using std::log;
  if (!(left > T(0) && centre > T(0) && right > T(0))) return parabola_offset(left, centre, right);
  return parabola_offset(T(log(left / centre)), T(0), T(log(right / centre)));
}

}  // namespace gladstone
