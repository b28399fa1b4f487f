#pragma once

#include <cstddef>

#include "cuda/device/device_array.h"
#include "cuda/rays/device_medium.h"
#include "render/focused_dots/deflection_map.h"

namespace gladstone::cuda::inline focused_dots {

/// Deflection table of a scene in device memory; counterpart of DeflectionMap on the host.
class DeviceDeflections {
 public:
  /// @throws OutOfDeviceMemory with the size of the whole table
  DeviceDeflections(FocusedDots const& dots, DeflectionTableLayout const& plan, DeviceMedium const& medium);

  /// Returns the table; exists() is false if the layout has none.
  DeflectionTable const& table() const { return table_; }

 private:
  DeflectionTable table_;
  DeviceArray<std::byte> values_;  ///< all values of the table: displacements, shifts, and their derivatives
};

}  // namespace gladstone::cuda::inline focused_dots
