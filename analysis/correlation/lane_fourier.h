#pragma once

#include <vector>

#include "analysis/correlation/float_lanes.h"

namespace gladstone {

/// The smallest number not below `least` that LaneFourier can transform: a product of 2, 3 and 5, divisible by four.
int lane_fourier_size(int least);

/// Fourier transforms along a line of eight windows side by side, without any exchange between lanes: passes of radix
/// 2, 3, 4, 5, 6 and 8 that sort themselves (Stockham, in Cochran et al., Proc. IEEE 55 (1967) 1664). Usual sizes have
/// code of their own, in which all distances are constants. A plan is shared by threads; what it works on is the
/// caller's.
class LaneFourier {
 public:
  /// @param size as lane_fourier_size() gives it
  explicit LaneFourier(int size);

  int size() const { return size_; }
  /// Values from row to row of a spectrum whose columns are transformed fastest: an odd number of cache lines, so that
  /// columns do not fall on the same places of the cache.
  static constexpr int pitch(int size) { return size + 1; }
  /// ComplexLanes that a call needs besides input and output.
  int scratch() const { return 2 * size_; }

  /// out(k) = sum over x of in(x) exp(-2 pi i k x / size).
  /// @param in         value x at in[x * in_stride]; those from `filled` on count as 0 and are not read
  /// @param out        size() values; another array than `in`
  void forward(ComplexLanes const* in, int in_stride, int filled, ComplexLanes* out, ComplexLanes* scratch) const;
  /// The same with the opposite sign in the exponent, without the division by the size, of size() values.
  void inverse(ComplexLanes const* in, ComplexLanes* out, ComplexLanes* scratch) const;

 private:
  int size_;
  std::vector<ComplexLanes> twiddles_;  ///< of each pass, radix - 1 a group
  void (*forward_)(ComplexLanes const* in, int in_stride, int filled, ComplexLanes* out, ComplexLanes* scratch,
                   ComplexLanes const* twiddles) = nullptr;  ///< null: none for this size
  void (*inverse_)(ComplexLanes const* in, ComplexLanes* out, ComplexLanes* scratch,
                   ComplexLanes const* twiddles) = nullptr;
};

}  // namespace gladstone
