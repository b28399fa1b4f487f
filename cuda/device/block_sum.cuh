#pragma once

namespace gladstone::cuda::inline device {

/// Sums `value` over the threads of a block whose indices are equal modulo `groups`, in an order that depends on the
/// block size only.
/// @param shared  one Value per thread; on return, the first `groups` contain the sums, readable by all threads
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

/// Returns the sum over all threads to every thread. @param shared  one Value per thread; may be reused on return
template <class Value>
__device__ Value block_sum(Value const& value, Value* shared) {
  block_sums(value, shared, 1);
  Value const sum = shared[0];
  __syncthreads();
  return sum;
}

}  // namespace gladstone::cuda::inline device
