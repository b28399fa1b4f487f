#include <cuda_runtime_api.h>

#include "cuda/device/runnable_code.h"

namespace gladstone::cuda::inline device {
namespace {

__global__ void any_kernel() {}

}  // namespace

std::string reason_code_cannot_run() {
  cudaFuncAttributes attributes{};
  if (cudaFuncGetAttributes(&attributes, any_kernel) != cudaSuccess) {
    cudaGetLastError();  // clear the error, so that the next launch is not reported as failed
    return "this build has code for sm_" GLADSTONE_CUDA_ARCHITECTURES
           " alone; build with CMAKE_OPTIONS=-DCMAKE_CUDA_ARCHITECTURES=native";
  }
  int device = 0, pools = 0;
  if (cudaGetDevice(&device) == cudaSuccess) cudaDeviceGetAttribute(&pools, cudaDevAttrMemoryPoolsSupported, device);
  cudaGetLastError();
  return pools != 0 ? "" : "its driver has no memory pools";
}

}  // namespace gladstone::cuda::inline device
