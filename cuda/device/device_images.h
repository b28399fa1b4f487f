#pragma once

#include <cstddef>

#include "cuda/device/device_light.h"

namespace gladstone::cuda::inline device {

/// Images under accumulation: 64-bit fixed point, row by row.
struct DeviceImages {
  unsigned long long* light[frame_count] = {};  ///< pixels of each frame; null: no images
  int columns = 0;
  int rows = 0;
  double units_per_weight = 0;  ///< fixed-point units per unit of ray weight
};

/// Accumulated images of frames A and B in device memory.
class ImagePairOnDevice {
 public:
  ImagePairOnDevice(int columns, int rows);

  DeviceImages view(double light_per_weight);
  void to_light(DeviceLight& light) const;

 private:
  std::size_t pixels() const { return static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_); }

  int columns_, rows_;
  DeviceArray<unsigned long long> light_[frame_count];
};

}  // namespace gladstone::cuda::inline device
