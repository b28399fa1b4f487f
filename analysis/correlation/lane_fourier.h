#pragma once

#include <vector>

#include "analysis/correlation/float_lanes.h"

namespace gladstone::inline correlation {

/// Returns the smallest size of a LaneFourier that is at least `least`: a product of 2, 3 and 5, divisible by four.
int lane_fourier_size(int least);

/// One-dimensional Fourier transforms of eight windows in SIMD lanes, without exchange between lanes: self-sorting
/// passes of radix 2, 3, 4, 5, 6 and 8 (Stockham, in Cochran et al., Proc. IEEE 55 (1967) 1664). Common sizes have
/// specialised code with compile-time strides. The object is immutable and may be shared by threads; buffers belong to
/// the caller.
class LaneFourier {
 public:
  /// @param size  a result of lane_fourier_size()
  explicit LaneFourier(int size);

  int size() const { return size_; }
  /// Row stride of a spectrum for fast transforms of its columns [ComplexLanes]: an odd number of cache lines, so that
  /// the values of a column do not map to the same cache sets.
  static constexpr int pitch(int size) { return size + 1; }
  /// Scratch memory per call, besides input and output [ComplexLanes].
  int scratch() const { return 2 * size_; }

  /// Computes out(k) = sum over x of in(x) exp(-2 pi i k x / size).
  /// @param in  value x at in[x * in_stride]; values from `filled` on count as 0 and are not read
  /// @param out  size() values; must not overlap `in`
  void forward(ComplexLanes const* in, int in_stride, int filled, ComplexLanes* out, ComplexLanes* scratch) const;
  /// Computes the transform with the opposite sign in the exponent, for size() contiguous values. The result is not
  /// divided by size().
  void inverse(ComplexLanes const* in, ComplexLanes* out, ComplexLanes* scratch) const;

 private:
  int size_;
  std::vector<ComplexLanes> twiddles_;  ///< twiddle factors of each pass, radix - 1 per group
  void (*forward_)(ComplexLanes const* in, int in_stride, int filled, ComplexLanes* out, ComplexLanes* scratch,
                   ComplexLanes const* twiddles) = nullptr;  ///< function specialised for this size; null: none exists
  void (*inverse_)(ComplexLanes const* in, ComplexLanes* out, ComplexLanes* scratch,
                   ComplexLanes const* twiddles) = nullptr;
};

}  // namespace gladstone::inline correlation
