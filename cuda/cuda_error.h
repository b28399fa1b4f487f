#pragma once

#include <cuda_runtime_api.h>

#include <cstddef>
#include <string>

#include "render/base/error.h"

namespace gladstone::cuda {

/// The device has no room left: callers may try again with less. what() names the sizes.
class OutOfDeviceMemory : public DeviceError {
 public:
  OutOfDeviceMemory(std::string const& what_for, std::size_t bytes);
};

/// Throws DeviceError naming the failed call, unless `status` says success.
void check(cudaError_t status, char const* call);

/// The same for the launch that went before; in a debug build it waits for the kernel to end.
void check_launch(char const* kernel);

}  // namespace gladstone::cuda
