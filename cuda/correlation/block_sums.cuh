#pragma once

namespace gladstone::cuda {

/// Sums over all threads of a block, in a fixed order; with a barrier before the sums are read, none after.
/// @param slots warps * count values of shared memory that nothing else uses
template <class T, int count>
__device__ void block_sums(T (&value)[count], T* slots) {
  unsigned const lane = threadIdx.x % 32u, warp = threadIdx.x / 32u, warps = blockDim.x / 32u;
#pragma unroll
  for (int k = 0; k < count; ++k) {
#pragma unroll
    for (int offset = 16; offset > 0; offset /= 2) value[k] += __shfl_xor_sync(0xffffffffu, value[k], offset);
    if (lane == 0) slots[warp * count + k] = value[k];
  }
  __syncthreads();
#pragma unroll
  for (int k = 0; k < count; ++k) {
    value[k] = T(0);
    for (unsigned w = 0; w < warps; ++w) value[k] += slots[w * count + k];
  }
}

}  // namespace gladstone::cuda
