#pragma once

namespace gladstone::cuda::inline device {

/// Image in device memory: grey levels row by row.
struct DeviceImage {
  double const* pixels;  ///< device address of columns * rows values
  int columns;
  int rows;
};

}  // namespace gladstone::cuda::inline device
