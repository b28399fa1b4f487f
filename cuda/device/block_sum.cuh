#pragma once

namespace gladstone::cuda {

/// Sums of `value` over those threads of a block whose numbers agree modulo `groups`, in an order that depends on the
/// block's size alone. @param shared one Value a thread; on return the sums in the first `groups`, for all to read
/// @pre blockDim.x and groups are powers of two
template <class Value>
__device__ void block_sums(Value const& value, Value* shared, unsigned int groups) {
  shared[threadIdx.x] = value;
  __syncthreads();
  for (unsigned int half = blockDim.x / 2; half >= groups; half /= 2) {
    if (threadIdx.x < half) shared[threadIdx.x] += shared[threadIdx.x + half];
    __syncthreads();
  }
}

/// The sum over all of them, every thread's. @param shared free again on return
template <class Value>
__device__ Value block_sum(Value const& value, Value* shared) {
  block_sums(value, shared, 1);
  Value const sum = shared[0];
  __syncthreads();
  return sum;
}

}  // namespace gladstone::cuda
