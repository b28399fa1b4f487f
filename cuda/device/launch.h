#pragma once

#include <cuda_runtime_api.h>

#include <algorithm>
#include <cstdint>

#include "cuda/device/cuda_error.h"
#include "cuda/device/device_memory.h"

namespace gladstone::cuda::inline device {

/// Maximum number of ray-tracing steps per launch, equivalent to a second or two. A running launch cannot be cancelled,
/// so Ctrl-C has to wait for it.
inline constexpr double max_steps_per_launch = 4e10;

/// Returns the number of blocks of a kernel that the device runs at the same time, at least 1.
template <class Kernel>
std::uint64_t resident_blocks(Kernel kernel, int threads, std::size_t shared_bytes) {
  int device = 0, processors = 0, of_processor = 0;
  check(cudaGetDevice(&device), "cudaGetDevice");
  check(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device), "cudaDeviceGetAttribute");
  check(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&of_processor, kernel, threads, shared_bytes),
        "cudaOccupancyMaxActiveBlocksPerMultiprocessor");
  return static_cast<std::uint64_t>(processors) * static_cast<std::uint64_t>(std::max(1, of_processor));
}

/// Returns the number of blocks that fills the device, at most `wanted`.
template <class Kernel>
int blocks_for(Kernel kernel, int threads, std::size_t shared_bytes, std::uint64_t wanted) {
  // Several waves, so that blocks with little work do not leave multiprocessors idle.
  std::uint64_t const most = 8 * resident_blocks(kernel, threads, shared_bytes);
  return static_cast<int>(std::max<std::uint64_t>(1, std::min(wanted, most)));
}

/// Returns the maximum dynamic shared memory of a block, in addition to the kernel's static shared memory [bytes].
template <class Kernel>
std::size_t most_shared_bytes(Kernel kernel) {
  int device = 0, of_block = 0;
  cudaFuncAttributes attributes{};
  check(cudaGetDevice(&device), "cudaGetDevice");
  check(cudaDeviceGetAttribute(&of_block, cudaDevAttrMaxSharedMemoryPerBlockOptin, device), "cudaDeviceGetAttribute");
  check(cudaFuncGetAttributes(&attributes, reinterpret_cast<void const*>(kernel)), "cudaFuncGetAttributes");
  std::size_t const most = std::min<std::size_t>(static_cast<std::size_t>(of_block), shared_memory_limit);
  return most - std::min(most, attributes.sharedSizeBytes);
}

/// Permits launches of a kernel with this amount of dynamic shared memory.
template <class Kernel>
void allow_shared_bytes(Kernel kernel, std::size_t bytes) {
  check(cudaFuncSetAttribute(reinterpret_cast<void const*>(kernel), cudaFuncAttributeMaxDynamicSharedMemorySize,
                             static_cast<int>(bytes)),
        "cudaFuncSetAttribute");
}

}  // namespace gladstone::cuda::inline device
