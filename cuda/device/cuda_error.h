#pragma once

#include <cuda_runtime_api.h>

#include "render/base/error.h"

namespace gladstone::cuda::inline device {

/// Throws DeviceError naming the failed call if `status` is an error.
void check(cudaError_t status, char const* call);

/// Checks the preceding kernel launch; debug builds also wait for the kernel to finish.
void check_launch(char const* kernel);

}  // namespace gladstone::cuda::inline device
