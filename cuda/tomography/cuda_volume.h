#pragma once

#include <memory>

#include "analysis/tomography/sart_volume.h"

namespace gladstone::cuda::inline tomography {

/// Creates a volume on the GPU. A thread integrates one line, or gathers the lines of one node in their order, so that
/// results are the same in every run; they differ from those of the CPU by rounding.
/// @throws OutOfDeviceMemory, DeviceError
std::unique_ptr<SartVolume> make_cuda_volume(SartProblem const& problem);

}  // namespace gladstone::cuda::inline tomography
