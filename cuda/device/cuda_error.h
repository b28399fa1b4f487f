#pragma once

#include <cuda_runtime_api.h>

#include "render/base/error.h"

namespace gladstone::cuda {

/// Throws DeviceError naming the failed call, unless `status` says success.
void check(cudaError_t status, char const* call);

/// The same for the launch that went before; in a debug build it waits for the kernel to end.
void check_launch(char const* kernel);

}  // namespace gladstone::cuda
