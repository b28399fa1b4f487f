#pragma once

#include <cmath>

#include "render/base/host_device.h"
#include "render/base/units.h"
#include "render/base/vec.h"

/// Operations on one interrogation window before and after its Fourier transform, row by row and without memory
/// allocation. The CUDA kernels use the same weights and cross spectrum, but sum over a window's pixels in parallel;
/// tests compare both window by window.
namespace gladstone {

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
/// (offset/window_px)^2) has the same area as the nominal window, so that the effective number of particles is the same
/// (Eckstein & Vlachos, Meas. Sci. Technol. 20 (2009) 055401). It is cut off where it has decreased to exp(-pi) =
/// 0.043.
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

/// One window on a pair of images. Pixel (i, j) of its support, 0 <= i, j < size, is image pixel (first_x + i, first_y
/// + j); pixels outside [begin, end) are outside the image and have weight 0.
template <class T>
struct WindowView {
  T const* reference;  ///< grey levels of the images, row by row, `columns` values per row
  T const* flow;
  T const* available;  ///< 1 if both images are known, otherwise 0; null: known everywhere
  int columns;
  int size;              ///< side of the support [px]
  int first_x, first_y;  ///< image position of the support's first pixel
  int begin_x, end_x;    ///< range of support pixels inside the image
  int begin_y, end_y;
  int core_begin, core_end;  ///< range of the nominal window within the support, on either axis
  T const* weight_x;         ///< `size` weights along each axis, 0 outside the image
  T const* weight_y;
};

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

/// Returns the sums over row j of a window. Partial sums are accumulated in eight interleaved lanes, so that the order
/// of summation is fixed and the loop vectorises.
template <class T>
GLADSTONE_HD WindowSums<T> sum_row(WindowView<T> const& w, int j) {
  constexpr int lanes = 8;
  T const wy = w.weight_y[j];
  long long const row = static_cast<long long>(w.first_y + j) * w.columns + w.first_x;
  T const* a = w.reference + row;
  T const* b = w.flow + row;
  T weight[lanes] = {}, reference[lanes] = {}, flow[lanes] = {};
  int i = w.begin_x;
  if (w.available == nullptr) {
    for (; i + lanes <= w.end_x; i += lanes)
      for (int l = 0; l < lanes; ++l) {
        T const weight_here = w.weight_x[i + l];
        weight[l] += weight_here;
        reference[l] += weight_here * a[i + l];
        flow[l] += weight_here * b[i + l];
      }
    for (int l = 0; i < w.end_x; ++i, ++l) {
      weight[l] += w.weight_x[i];
      reference[l] += w.weight_x[i] * a[i];
      flow[l] += w.weight_x[i] * b[i];
    }
  } else {
    T const* known = w.available + row;
    for (; i < w.end_x; ++i) {
      T const weight_here = w.weight_x[i] * known[i];
      weight[i % lanes] += weight_here;
      reference[i % lanes] += weight_here * a[i];
      flow[i % lanes] += weight_here * b[i];
    }
  }
  WindowSums<T> sums;
  for (int l = 0; l < lanes; ++l) {
    sums.weight += weight[l];
    sums.reference += reference[l];
    sums.flow += flow[l];
  }
  return {wy * sums.weight, wy * sums.reference, wy * sums.flow};
}

/// Sums of squares of the weighted windows without their mean.
template <class T>
struct WindowEnergy {
  T reference{};
  T flow{};
  T core_reference{};  ///< sum over the nominal window only
  T core_flow{};

  GLADSTONE_HD WindowEnergy& operator+=(WindowEnergy o) {
    reference += o.reference;
    flow += o.flow;
    core_reference += o.core_reference;
    core_flow += o.core_flow;
    return *this;
  }
};

/// Writes row j of both windows, mean removed and weighted, as real (reference) and imaginary (flow) parts, and returns
/// its energy.
/// @param mean_reference, mean_flow  weighted means over the window
/// @param out  `size` complex values, as pairs of real and imaginary part
template <class T>
GLADSTONE_HD WindowEnergy<T> load_row(WindowView<T> const& w, int j, T mean_reference, T mean_flow, T* out) {
  constexpr int lanes = 8;
  for (int i = 0; i < 2 * w.begin_x; ++i) out[i] = T(0);
  for (int i = 2 * w.end_x; i < 2 * w.size; ++i) out[i] = T(0);
  T const wy = w.weight_y[j];
  long long const row = static_cast<long long>(w.first_y + j) * w.columns + w.first_x;
  T const* a = w.reference + row;
  T const* b = w.flow + row;
  T const* known = w.available == nullptr ? nullptr : w.available + row;
  for (int i = w.begin_x; i < w.end_x; ++i) {
    T const weight = wy * w.weight_x[i];
    out[2 * i] = weight * (a[i] - mean_reference);
    out[2 * i + 1] = weight * (b[i] - mean_flow);
  }
  if (known != nullptr)
    for (int i = w.begin_x; i < w.end_x; ++i) {
      out[2 * i] *= known[i];
      out[2 * i + 1] *= known[i];
    }
  // Squares of both windows, interleaved as in `out`; the core is summed before the pixels on either side of it.
  auto const squares = [&](int first, int last, T& reference, T& flow) {
    T sum[lanes] = {};
    int k = 2 * first;
    for (; k + lanes <= 2 * last; k += lanes)
      for (int l = 0; l < lanes; ++l) sum[l] += out[k + l] * out[k + l];
    for (int l = 0; k < 2 * last; ++k, ++l) sum[l] += out[k] * out[k];
    for (int l = 0; l < lanes; l += 2) {
      reference += sum[l];
      flow += sum[l + 1];
    }
  };
  WindowEnergy<T> energy;
  squares(w.core_begin, w.core_end, energy.reference, energy.flow);
  if (j >= w.core_begin && j < w.core_end) {
    energy.core_reference = energy.reference;
    energy.core_flow = energy.flow;
  }
  squares(0, w.core_begin, energy.reference, energy.flow);
  squares(w.core_end, w.size, energy.reference, energy.flow);
  return energy;
}

/// Returns the cross spectrum conj(A) B (real and imaginary part) at wave vector k of two real windows a and b that
/// were transformed together as a + i b. With Z the transform at k and M that at -k: A = (Z + conj M)/2 and B = (Z -
/// conj M)/(2i).
template <class T>
GLADSTONE_HD Vec2<T> cross_spectrum(T z_real, T z_imaginary, T m_real, T m_imaginary) {
  return {T(0.5) * (z_real * m_imaginary + z_imaginary * m_real),
          T(0.25) * (m_real * m_real + m_imaginary * m_imaginary - z_real * z_real - z_imaginary * z_imaginary)};
}

}  // namespace gladstone
