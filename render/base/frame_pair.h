#pragma once

#include <utility>

#include "render/base/image.h"

namespace gladstone {

/// Pair of frames of equal size, in host or device memory: the input of a correlator. Grey levels are real numbers.
class FramePair {
 public:
  virtual ~FramePair() = default;
  /// Returns frame A (BOS: the reference image) in host memory. For frames in device memory, the first call copies them
  /// to the host; it must not run concurrently with another call.
  virtual Image<double> const& reference() const = 0;
  /// Returns frame B (BOS: the measurement image) in host memory, under the same conditions as reference().
  virtual Image<double> const& flow() const = 0;
};

/// Pair of frames in host memory.
class HostFrames final : public FramePair {
 public:
  HostFrames(Image<double> reference, Image<double> flow) : reference_(std::move(reference)), flow_(std::move(flow)) {}
  Image<double> const& reference() const override { return reference_; }
  Image<double> const& flow() const override { return flow_; }

 private:
  Image<double> reference_, flow_;
};

}  // namespace gladstone
