#pragma once

namespace gladstone::cuda::inline correlation {

/// Sums each value over all threads of a block, in a fixed order, and returns the sums to every thread. Contains a
/// barrier before the sums are read, but none after.
/// @param slots  32 * count values of shared memory for exclusive use
/// @pre at most 32 warps, all of them full
template <class T, int count>
__device__ void block_sums(T (&value)[count], T* slots) {
  unsigned const lane = threadIdx.x % 32u, warp = threadIdx.x / 32u, warps = blockDim.x / 32u;
  auto const sum_of_warp = [](T& sum) {
#pragma unroll
    for (int offset = 16; offset > 0; offset /= 2) sum += __shfl_xor_sync(0xffffffffu, sum, offset);
  };
#pragma unroll
  for (int k = 0; k < count; ++k) {
    sum_of_warp(value[k]);
    if (lane == 0) slots[warp * count + k] = value[k];
  }
  __syncthreads();
#pragma unroll
  for (int k = 0; k < count; ++k) {
    value[k] = lane < warps ? slots[lane * count + k] : T(0);
    sum_of_warp(value[k]);
  }
}

}  // namespace gladstone::cuda::inline correlation
