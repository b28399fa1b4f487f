#pragma once

#include <cstdint>
#include <mutex>
#include <utility>

#include "render/base/frame_pair.h"

namespace gladstone::inline base {

/// Grey levels in host memory, stored as the integers that a camera wrote. They are converted to real numbers once, for
/// the first correlator.
class IntegerFrames final : public StoredFrames {
 public:
  explicit IntegerFrames(FramePair<std::uint16_t> levels) : levels_(std::move(levels)) {}
  Image<double> const& reference() const override { return real_numbers().reference; }
  Image<double> const& flow() const override { return real_numbers().flow; }
  FramePair<std::uint16_t> integers() const override { return levels_; }

 private:
  FramePair<double> const& real_numbers() const;

  FramePair<std::uint16_t> levels_;
  mutable std::once_flag converted_;
  mutable FramePair<double> real_numbers_;
};

}  // namespace gladstone::inline base
