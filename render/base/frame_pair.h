#pragma once

#include <cstdint>
#include <utility>

#include "render/base/image.h"

namespace gladstone::inline base {

/// Frame A (BOS: the reference image) and frame B (BOS: the measurement image), of equal size, in host memory.
template <class Pixel>
struct FramePair {
  Image<Pixel> reference, flow;
};

/// Converts grey levels, which are whole numbers from 0 to 65535, to integers.
Image<std::uint16_t> integer_levels(Image<double> const& levels);

/// Grey levels of a pair of frames in host or device memory: the input of a correlator.
class StoredFrames {
 public:
  virtual ~StoredFrames() = default;
  /// Returns frame A in host memory. For frames in device memory, the first call copies them to the host; it must not
  /// run concurrently with another call.
  virtual Image<double> const& reference() const = 0;
  /// Returns frame B in host memory, under the same conditions as reference().
  virtual Image<double> const& flow() const = 0;
  /// Returns both frames as integers in host memory, under the same conditions as reference().
  /// @pre all grey levels are whole numbers from 0 to 65535, as a camera records them
  virtual FramePair<std::uint16_t> integers() const;
};

/// Grey levels in host memory.
class HostFrames final : public StoredFrames {
 public:
  HostFrames(Image<double> reference, Image<double> flow) : levels_{std::move(reference), std::move(flow)} {}
  explicit HostFrames(FramePair<double> levels) : levels_(std::move(levels)) {}
  Image<double> const& reference() const override { return levels_.reference; }
  Image<double> const& flow() const override { return levels_.flow; }

 private:
  FramePair<double> levels_;
};

}  // namespace gladstone::inline base
