#pragma once

#include <cstddef>
#include <memory>

#include "render/base/frame_pair.h"
#include "render/sensor/detector.h"

namespace gladstone {

/// Two frames as light per pixel, in fully lit pixels on the axis; noise-free, not rounded.
struct LightPair {
  Image<double> reference;
  Image<double> flow;
};

/// What a camera records of both frames.
struct RecordedFrames {
  std::shared_ptr<FramePair const> levels;  ///< whole grey levels
  std::size_t saturated_reference = 0;      ///< pixels at full well or full scale
  std::size_t saturated_flow = 0;
};

/// The light of a rendering where the renderer has made it; what cameras make of it stays there, too.
class RenderedLight {
 public:
  virtual ~RenderedLight() = default;
  virtual LightPair to_host() const = 0;
  /// Light of the brightest pixel of both frames.
  virtual double brightest() const = 0;
  /// As Detector::record, the two frames with a noise of their own each.
  virtual RecordedFrames record(Detector const& detector) const = 0;
  /// As Detector::ideal.
  virtual std::unique_ptr<FramePair const> ideal(Detector const& detector) const = 0;
};

/// Light in the host's memory.
class HostLight final : public RenderedLight {
 public:
  explicit HostLight(LightPair light) : light_(std::move(light)) {}
  LightPair to_host() const override { return light_; }
  double brightest() const override;
  RecordedFrames record(Detector const& detector) const override;
  std::unique_ptr<FramePair const> ideal(Detector const& detector) const override;

 private:
  LightPair light_;
};

}  // namespace gladstone
