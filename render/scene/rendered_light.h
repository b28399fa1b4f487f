#pragma once

#include <cstddef>
#include <memory>

#include "render/base/frame_pair.h"
#include "render/sensor/detector.h"

namespace gladstone::inline scene {

/// Two images as recorded by a camera.
struct RecordedFrames {
  std::shared_ptr<StoredFrames const> levels;  ///< integer grey levels
  std::size_t saturated_reference = 0;         ///< number of pixels at full well or full scale
  std::size_t saturated_flow = 0;
};

/// Light of a rendering in the memory of the device that rendered it: of each pixel, in units of a fully lit pixel on
/// the axis, noise-free and not rounded. Recorded images remain on that device, too.
class RenderedLight {
 public:
  virtual ~RenderedLight() = default;
  virtual FramePair<double> to_host() const = 0;
  /// Light of the brightest pixel of both frames.
  virtual double brightest() const = 0;
  /// Records both images with independent noise, see Detector::record().
  virtual RecordedFrames record(Detector const& detector) const = 0;
  /// Converts both images to grey levels without background and noise, see Detector::ideal().
  virtual std::unique_ptr<StoredFrames const> ideal(Detector const& detector) const = 0;
};

/// Light in host memory.
class HostLight final : public RenderedLight {
 public:
  explicit HostLight(FramePair<double> light) : light_(std::move(light)) {}
  FramePair<double> to_host() const override { return light_; }
  double brightest() const override;
  RecordedFrames record(Detector const& detector) const override;
  std::unique_ptr<StoredFrames const> ideal(Detector const& detector) const override;

 private:
  FramePair<double> light_;
};

}  // namespace gladstone::inline scene
