#pragma once

#include "cuda/device_array.h"
#include "cuda/device_medium.h"
#include "render/scene/deflection_map.h"

namespace gladstone::cuda {

/// A scene's deflection table in the device's memory, as DeflectionMap is in the host's.
class DeviceDeflections {
 public:
  DeviceDeflections(Scene const& scene, DeflectionPlan const& plan, DeviceMedium<double> const& medium);

  /// exists() only where it was wanted.
  DeflectionTable const& table() const { return table_; }

 private:
  DeflectionTable table_;
  DeviceArray<KeptVector> displacements_, bends_;
  DeviceArray<KeptSlopes> displacement_slopes_, bend_slopes_;
};

}  // namespace gladstone::cuda
