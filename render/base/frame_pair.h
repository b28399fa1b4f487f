#pragma once

#include <utility>

#include "render/base/image.h"

namespace gladstone::inline base {

/// Frame A (BOS: the reference image) and frame B (BOS: the measurement image), of equal size, in host memory.
template <class Pixel>
struct FramePair {
  Image<Pixel> reference, flow;
};

/// Grey levels of a pair of frames in host or device memory, as real numbers: the input of a correlator.
class StoredFrames {
 public:
  virtual ~StoredFrames() = default;
  /// Returns frame A in host memory. For frames in device memory, the first call copies them to the host; it must not
  /// run concurrently with another call.
  virtual Image<double> const& reference() const = 0;
  /// Returns frame B in host memory, under the same conditions as reference().
  virtual Image<double> const& flow() const = 0;
};

/// Grey levels in host memory.
class HostFrames final : public StoredFrames {
 public:
  HostFrames(Image<double> reference, Image<double> flow) : levels_{std::move(reference), std::move(flow)} {}
  Image<double> const& reference() const override { return levels_.reference; }
  Image<double> const& flow() const override { return levels_.flow; }

 private:
  FramePair<double> levels_;
};

}  // namespace gladstone::inline base
