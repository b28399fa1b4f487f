#pragma once

#include <vector>

#include "analysis/correlation/float_lanes.h"

namespace gladstone {

/// The smallest number not below `least` that LaneFourier can transform: a product of 2, 3 and 5, divisible by four.
int lane_fourier_size(int least);

/// Fourier transforms along a line of eight windows side by side, without any exchange between lanes: passes of radix
/// 4, 2, 3 and 5 that sort themselves (Stockham, in Cochran et al., Proc. IEEE 55 (1967) 1664). A plan is shared by
/// threads; what it works on is the caller's.
class LaneFourier {
 public:
  /// @param size as lane_fourier_size() gives it
  explicit LaneFourier(int size);

  int size() const { return size_; }
  /// ComplexLanes that a call needs besides input and output.
  int scratch() const { return 2 * size_; }

  /// out(k) = sum over x of in(x) exp(-2 pi i k x / size).
  /// @param in         value x at in[x * in_stride]; those from `filled` on count as 0 and are not read
  /// @param out        value k at out[k * out_stride]; another array than `in`
  void forward(ComplexLanes const* in, int in_stride, int filled, ComplexLanes* out, int out_stride,
               ComplexLanes* scratch) const;
  /// The same with the opposite sign in the exponent, without the division by the size; all of `in` is read.
  void inverse(ComplexLanes const* in, int in_stride, ComplexLanes* out, int out_stride, ComplexLanes* scratch) const;

 private:
  struct Pass {
    int radix;
    int groups;  ///< different twiddle factors, m
    int stride;  ///< butterflies with the same factor, s
    int first;   ///< of its factors in twiddles_
  };
  template <bool backward>
  void transform(ComplexLanes const* in, int in_stride, int filled, ComplexLanes* out, int out_stride,
                 ComplexLanes* scratch) const;

  int size_;
  std::vector<Pass> passes_;
  std::vector<float> twiddles_;  ///< cosine and sine, radix - 1 pairs a group
};

}  // namespace gladstone
