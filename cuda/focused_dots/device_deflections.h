#pragma once

#include <cstddef>

#include "cuda/device/device_array.h"
#include "cuda/rays/device_medium.h"
#include "render/focused_dots/deflection_map.h"

namespace gladstone::cuda {

/// A scene's deflection table in the device's memory, as DeflectionMap is in the host's.
class DeviceDeflections {
 public:
  /// @throws OutOfDeviceMemory naming the size of the whole table
  DeviceDeflections(FocusedDots const& dots, DeflectionPlan const& plan, DeviceMedium<double> const& medium);

  /// exists() only where it was wanted.
  DeflectionTable const& table() const { return table_; }

 private:
  DeflectionTable table_;
  DeviceArray<std::byte> values_;  ///< all of the table's: displacements, shifts, and the slopes of both
};

}  // namespace gladstone::cuda
