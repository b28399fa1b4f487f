#pragma once

#include "cuda/device/device_images.h"

namespace gladstone::cuda::inline device {

/// Rounds a contribution to a pixel to whole units of the images' fixed point. Sums of whole numbers are exact, so that
/// images depend neither on the order of the contributions nor on intermediate accumulators.
__device__ inline double whole_units(double units) { return rint(units); }

/// Adds light to a pixel; pixels outside the image are ignored. @param units  whole number
__device__ inline void add_light(DeviceImages const& images, Frame frame, int column, int row, double units) {
  if (column < 0 || row < 0 || column >= images.columns || row >= images.rows) return;
  auto const share = static_cast<unsigned long long>(static_cast<long long>(units));
  atomicAdd(images.light[static_cast<int>(frame)] + static_cast<std::size_t>(row) * images.columns + column, share);
}

}  // namespace gladstone::cuda::inline device
