#pragma once

#include "cuda/device/device_array.h"
#include "cuda/device/device_frames.h"
#include "render/scene/ray_hit.h"
#include "render/scene/rendered_light.h"

namespace gladstone::cuda::inline device {

/// Light of both frames in device memory, with a camera model that runs on the device.
class DeviceLight final : public RenderedLight {
 public:
  /// The light is uninitialised and must be written by the renderer.
  DeviceLight(int columns, int rows);

  double* light(Frame frame) { return light_[static_cast<int>(frame)].data(); }
  /// Replaces the light L by W - L, with the light W of a white target, for dark dots on a white target.
  void take_from(Image<double> const& white);
  /// Copies the light to the host. @param staging  page-locked buffer; all cores copy one frame from it while the other
  /// is being transferred
  FramePair<double> to_host(PinnedBuffer& staging) const;

  FramePair<double> to_host() const override;
  double brightest() const override;
  RecordedFrames record(Detector const& detector) const override;
  std::unique_ptr<StoredFrames const> ideal(Detector const& detector) const override;

 private:
  std::size_t pixels() const { return static_cast<std::size_t>(columns_) * static_cast<std::size_t>(rows_); }

  int columns_, rows_;
  DeviceArray<double> light_[frame_count];
};

}  // namespace gladstone::cuda::inline device
