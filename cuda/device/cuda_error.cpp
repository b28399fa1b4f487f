#include "cuda/device/cuda_error.h"

#include <fmt/format.h>

namespace gladstone::cuda::inline device {

void check(cudaError_t status, char const* call) {
  if (status == cudaSuccess) return;
  cudaGetLastError();  // clear the error, so that the next launch is not reported as failed
  throw DeviceError(
      fmt::format("CUDA: {} failed: {} ({})", call, cudaGetErrorString(status), cudaGetErrorName(status)));
}

void check_launch(char const* kernel) {
  check(cudaGetLastError(), kernel);
#ifndef NDEBUG
  check(cudaDeviceSynchronize(), kernel);
#endif
}

}  // namespace gladstone::cuda::inline device
