#pragma once

namespace gladstone::cuda {

/// Sum of `value` over a block's threads, in an order that depends on the block's size alone. The result is every
/// thread's. @param shared one Value a thread; free again on return @pre blockDim.x is a power of two
template <class Value>
__device__ Value block_sum(Value const& value, Value* shared) {
  shared[threadIdx.x] = value;
  __syncthreads();
  for (unsigned int half = blockDim.x / 2; half > 0; half /= 2) {
    if (threadIdx.x < half) shared[threadIdx.x] += shared[threadIdx.x + half];
    __syncthreads();
  }
  Value const sum = shared[0];
  __syncthreads();
  return sum;
}

}  // namespace gladstone::cuda
