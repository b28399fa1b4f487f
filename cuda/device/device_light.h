#pragma once

#include "cuda/device/device_array.h"
#include "cuda/device/device_frames.h"
#include "render/scene/ray_hit.h"
#include "render/scene/rendered_light.h"

namespace gladstone::cuda {

/// Light of both frames in the device's memory, and a camera for it there.
class DeviceLight final : public RenderedLight {
 public:
  /// Light per pixel is for the renderer to write.
  DeviceLight(int columns, int rows);

  double* light(Frame frame) { return light_[static_cast<int>(frame)].data(); }
  /// Takes the dots from a white target: what is there becomes white minus that.
  void take_from(Image<double> const& white);
  /// @param staging that the device copies to; all cores copy one frame on from there while the other is on its way
  LightPair to_host(PinnedBuffer& staging) const;

  LightPair to_host() const override;
  double brightest() const override;
  RecordedFrames record(Detector const& detector) const override;
  std::unique_ptr<FramePair const> ideal(Detector const& detector) const override;

 private:
  std::size_t pixels() const { return static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_); }

  int columns_, rows_;
  DeviceArray<double> light_[frame_count];
};

}  // namespace gladstone::cuda
