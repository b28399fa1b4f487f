#include "cuda/cuda_error.h"

#include <fmt/format.h>

namespace gladstone::cuda {
namespace {

constexpr double mebibyte = 1024.0 * 1024.0;

std::string shortage(std::string const& what_for, std::size_t bytes) {
  std::size_t free = 0, total = 0;
  cudaMemGetInfo(&free, &total);
  return fmt::format(
      "out of device memory: {} needs {:.0f} MiB, {:.0f} of {:.0f} MiB are free; use fewer rays, smaller "
      "images or volumes, or --device cpu",
      what_for, static_cast<double>(bytes) / mebibyte, static_cast<double>(free) / mebibyte,
      static_cast<double>(total) / mebibyte);
}

}  // namespace

OutOfDeviceMemory::OutOfDeviceMemory(std::string const& what_for, std::size_t bytes)
    : DeviceError(shortage(what_for, bytes)) {}

void check(cudaError_t status, char const* call) {
  if (status == cudaSuccess) return;
  throw DeviceError(
      fmt::format("CUDA: {} failed: {} ({})", call, cudaGetErrorString(status), cudaGetErrorName(status)));
}

void check_launch(char const* kernel) {
  check(cudaGetLastError(), kernel);
#ifndef NDEBUG
  check(cudaDeviceSynchronize(), kernel);
#endif
}

}  // namespace gladstone::cuda
