#pragma once

#include <string>

#include "analysis/tomography/sart_volume.h"

namespace gladstone {

/// Opens a device for tomographic reconstructions and logs which one is used.
/// @param wanted  "cpu", "cuda", or "auto": the GPU if one is usable
/// @throws DeviceError if "cuda" is not available, with the reason
tomography::SartVolumeMaker open_volume_device(std::string const& wanted);

}  // namespace gladstone
