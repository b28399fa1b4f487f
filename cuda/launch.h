#pragma once

#include <cuda_runtime_api.h>

#include <algorithm>
#include <cstdint>

#include "cuda/cuda_error.h"

namespace gladstone::cuda {

/// Blocks that fill the device with a kernel, but no more than the work needs.
template <class Kernel>
int blocks_for(Kernel kernel, int threads, std::size_t shared_bytes, std::uint64_t wanted) {
  int device = 0, processors = 0, resident = 0;
  check(cudaGetDevice(&device), "cudaGetDevice");
  check(cudaDeviceGetAttribute(&processors, cudaDevAttrMultiProcessorCount, device), "cudaDeviceGetAttribute");
  check(cudaOccupancyMaxActiveBlocksPerMultiprocessor(&resident, kernel, threads, shared_bytes),
        "cudaOccupancyMaxActiveBlocksPerMultiprocessor");
  // several rounds, so that blocks whose work is short do not leave processors idle
  std::uint64_t const most =
      8 * static_cast<std::uint64_t>(processors) * static_cast<std::uint64_t>(std::max(1, resident));
  return static_cast<int>(std::max<std::uint64_t>(1, std::min(wanted, most)));
}

}  // namespace gladstone::cuda
