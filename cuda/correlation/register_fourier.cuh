#pragma once

#include "cuda/correlation/small_transform.h"

/// Fourier transforms of 16 or 32 values in the registers of one thread: all indices are compile-time constants in
/// unrolled loops.
namespace gladstone::cuda::inline correlation {

/// Transforms `size` values in place: sum over n of z(n) exp(sign 2 pi i k n / size); value k is written to
/// z[place(k)].
template <int size, int sign>
struct RegisterFourier {
  static_assert(size == 16 || size == 32);
  static constexpr int outer = size == 16 ? 4 : 8;
  static constexpr int inner = size / outer;

  GLADSTONE_HD static constexpr int place(int k) { return inner * (k % outer) + k / outer; }

  __device__ static void apply(Complex* z) {
#pragma unroll
    for (int n = 0; n < inner; ++n) {
      small_transform<outer, sign, inner>(z + n);
      if (n > 0) {
#pragma unroll
        for (int k = 1; k < outer; ++k) z[inner * k + n] = z[inner * k + n] * unit_root<size, sign>(n * k);
      }
    }
#pragma unroll
    for (int k = 0; k < outer; ++k) small_transform<inner, sign, 1>(z + inner * k);
  }
};

}  // namespace gladstone::cuda::inline correlation
