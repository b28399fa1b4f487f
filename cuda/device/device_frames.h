#pragma once

#include "cuda/device/device_array.h"
#include "cuda/device/device_image.h"
#include "render/base/frame_pair.h"
#include "render/base/image.h"
#include "render/scene/ray_hit.h"

namespace gladstone::cuda::inline device {

/// Grey levels of frames A and B in device memory; copied to the host on first access.
class DeviceFrames final : public StoredFrames {
 public:
  DeviceFrames(int columns, int rows);

  DeviceImage image(Frame frame) const { return {levels(frame), columns_, rows_}; }
  double* levels(Frame frame) { return levels_[static_cast<int>(frame)].data(); }
  double const* levels(Frame frame) const { return levels_[static_cast<int>(frame)].data(); }
  Image<double> const& reference() const override { return on_host(Frame::reference); }
  Image<double> const& flow() const override { return on_host(Frame::flow); }

 private:
  Image<double> const& on_host(Frame frame) const;

  int columns_, rows_;
  DeviceArray<double> levels_[frame_count];
  mutable Image<double> on_host_[frame_count];
};

}  // namespace gladstone::cuda::inline device
