#include "cuda/cuda_error.h"

#include <fmt/format.h>

#include "cuda/device_memory.h"

namespace gladstone::cuda {
namespace {

/// In MiB, small sizes with their decimals.
std::string mebibytes(std::size_t bytes) {
  double const size = static_cast<double>(bytes) / 0x1p20;
  return fmt::format("{:.{}f}", size, size < 10 ? 3 : 0);
}

std::string shortage(std::string const& what_for, std::size_t bytes) {
  DeviceRoom const room = device_room();
  return fmt::format(
      "out of device memory: {} needs {} MiB, {} of {} MiB are free; use fewer rays, smaller images or volumes, or "
      "--device cpu",
      what_for, mebibytes(bytes), mebibytes(room.free), mebibytes(room.total));
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
