#pragma once

#include <utility>

#include "render/base/image.h"

namespace gladstone {

/// Grey levels of two frames of one size, wherever they are kept: what a correlator takes.
class FramePair {
 public:
  virtual ~FramePair() = default;
  /// In the host's memory; frames that are kept elsewhere are copied when they are first asked for, by one thread.
  virtual Image<double> const& reference() const = 0;
  virtual Image<double> const& flow() const = 0;
};

/// Frames in the host's memory.
class HostFrames final : public FramePair {
 public:
  HostFrames(Image<double> reference, Image<double> flow) : reference_(std::move(reference)), flow_(std::move(flow)) {}
  Image<double> const& reference() const override { return reference_; }
  Image<double> const& flow() const override { return flow_; }

 private:
  Image<double> reference_, flow_;
};

}  // namespace gladstone
