#pragma once

#include <cmath>

#include "render/base/host_device.h"
#include "render/base/units.h"
#include "render/base/vec.h"

/// Weights of the pixels of an interrogation window and its cross spectrum, for the CPU and the CUDA kernels.
namespace gladstone::inline correlation {

/// Weighting of the pixels of a window.
enum class WindowWeighting {
  uniform,   ///< 1 over the nominal window
  gaussian,  ///< Gaussian over twice the nominal window
};

/// Returns the half-width of the pixels with non-zero weight for a nominal window of window_px [px].
template <class T>
GLADSTONE_HD T window_half_support(WindowWeighting weighting, T window_px) {
  return weighting == WindowWeighting::gaussian ? window_px : window_px / T(2);
}

/// Returns the side of the square of pixels with non-zero weight for a nominal window of window_px [px].
GLADSTONE_HD constexpr int window_side_px(WindowWeighting weighting, int window_px) {
  return weighting == WindowWeighting::gaussian ? 2 * window_px : window_px;
}

/// Returns the weight along one axis; the weight of a pixel is the product over both axes. The Gaussian exp(-pi
/// (offset/window_px)^2) has the same area as the nominal window, so that the effective number of particles equals that
/// in the nominal window (Eckstein & Vlachos, Meas. Sci. Technol. 20 (2009) 055401). The Gaussian is cut off where it
/// has decreased to exp(-pi) = 0.043.
/// @param offset  distance from the window's centre [px]
/// @param window_px  nominal window size [px]
template <class T>
GLADSTONE_HD T axis_weight(WindowWeighting weighting, T offset, T window_px) {
  using std::exp;
  T const half = window_half_support(weighting, window_px);
  if (offset > half || offset < -half) return T(0);
  if (weighting == WindowWeighting::uniform) return T(1);
  T const relative = offset / window_px;
  return T(exp(-T(pi) * relative * relative));
}

/// Sums of the weights and of the weighted grey levels of both images over a window.
template <class T>
struct WindowSums {
  T weight{};
  T reference{};
  T flow{};

  GLADSTONE_HD WindowSums& operator+=(WindowSums o) {
    weight += o.weight;
    reference += o.reference;
    flow += o.flow;
    return *this;
  }
};

/// Sums of squares of the weighted windows without their mean.
struct WindowEnergy {
  float reference = 0.0f;
  float flow = 0.0f;
  float core_reference = 0.0f;  ///< sum of frame A over the nominal window only
  float core_flow = 0.0f;
};

/// Returns the cross spectrum conj(A) B (real and imaginary part) at wave vector k of two real windows a and b that
/// were transformed together as a + i b. With Z the transform at k and M that at -k: A = (Z + conj M)/2 and B = (Z -
/// conj M)/(2i).
template <class T>
GLADSTONE_HD Vec2<T> cross_spectrum(T z_real, T z_imaginary, T m_real, T m_imaginary) {
  return {T(0.5) * (z_real * m_imaginary + z_imaginary * m_real),
          T(0.25) * (m_real * m_real + m_imaginary * m_imaginary - z_real * z_real - z_imaginary * z_imaginary)};
}

}  // namespace gladstone::inline correlation
