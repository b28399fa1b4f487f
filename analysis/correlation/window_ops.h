#pragma once

#include <cmath>

#include "render/base/host_device.h"
#include "render/base/units.h"
#include "render/base/vec.h"

/// What happens to one interrogation window before and after its Fourier transform, row by row, without allocation. The
/// CPU runs it so; CUDA's kernels share the cross spectrum, the order and the refinement of peaks and their ratio, and
/// take the sums over a window's pixels by the threads that hold them: tests compare the two window by window.
namespace gladstone {

/// How the pixels of a window count.
enum class WindowWeighting {
  uniform,   ///< 1 over the nominal window
  gaussian,  ///< Gaussian over twice the nominal window
};

/// Half-width of the pixels that a window of nominal size window_px uses [px].
template <class T>
GLADSTONE_HD T window_half_support(WindowWeighting weighting, T window_px) {
  return weighting == WindowWeighting::gaussian ? window_px : window_px / T(2);
}

/// Side of the square of pixels that a window of nominal size window_px gives weight [px].
GLADSTONE_HD constexpr int window_side_px(WindowWeighting weighting, int window_px) {
  return weighting == WindowWeighting::gaussian ? 2 * window_px : window_px;
}

/// Weight along one axis; the weight of a pixel is the product over both axes. The Gaussian has the area of the nominal
/// window, exp(-pi (offset/window_px)^2), so that as many particles count (Eckstein & Vlachos, Meas. Sci. Technol. 20
/// (2009) 055401), and is cut where it has fallen to exp(-pi) = 0.043.
/// @param offset    distance from the window's centre [px]
/// @param window_px nominal window size [px]
template <class T>
GLADSTONE_HD T axis_weight(WindowWeighting weighting, T offset, T window_px) {
  using std::exp;
  T const half = window_half_support(weighting, window_px);
  if (offset > half || offset < -half) return T(0);
  if (weighting == WindowWeighting::uniform) return T(1);
  T const relative = offset / window_px;
  return T(exp(-T(pi) * relative * relative));
}

/// One window on a pair of images. Pixel (i, j) of its support, 0 <= i, j < size, is image pixel (first_x + i,
/// first_y + j); pixels outside [begin, end) are not in the image and have weight 0.
template <class T>
struct WindowView {
  T const* reference;  ///< images, row by row, `columns` values in a row
  T const* flow;
  T const* available;  ///< 1 where both images are known, 0 elsewhere; null: everywhere
  int columns;
  int size;              ///< side of the support [px]
  int first_x, first_y;  ///< image position of the support's first pixel
  int begin_x, end_x;    ///< part of the support inside the image
  int begin_y, end_y;
  int core_begin, core_end;  ///< the nominal window within the support, on either axis
  T const* weight_x;         ///< `size` weights along each axis, 0 outside the image
  T const* weight_y;
};

/// Weighted sums over a window: of 1 and of either image.
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

/// Sums over row j of a window. Partial sums run over eight interleaved lanes, so that the order of summation is
/// fixed and the loop vectorises.
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

/// Sums of squares of the weighted, mean-free windows.
template <class T>
struct WindowEnergy {
  T reference{};
  T flow{};
  T core_reference{};  ///< the same over the nominal window only
  T core_flow{};

  GLADSTONE_HD WindowEnergy& operator+=(WindowEnergy o) {
    reference += o.reference;
    flow += o.flow;
    core_reference += o.core_reference;
    core_flow += o.core_flow;
    return *this;
  }
};

/// Writes row j of both windows, mean removed and weighted, as real (reference) and imaginary (flow) parts.
/// @param mean_reference, mean_flow the weighted means over the window
/// @param out `size` complex values as pairs
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
  // squares of both windows interleaved, as they lie in `out`; the core apart from its two sides
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

/// Cross spectrum conj(A) B at wave vector k of two real windows a and b that were transformed together as a + i b:
/// with Z the transform at k and M that at -k, A = (Z + conj M)/2 and B = (Z - conj M)/(2i). @return real and imaginary
/// part
template <class T>
GLADSTONE_HD Vec2<T> cross_spectrum(T z_real, T z_imaginary, T m_real, T m_imaginary) {
  return {T(0.5) * (z_real * m_imaginary + z_imaginary * m_real),
          T(0.25) * (m_real * m_real + m_imaginary * m_imaginary - z_real * z_real - z_imaginary * z_imaginary)};
}

}  // namespace gladstone
