#pragma once

#include <optional>
#include <utility>

#include "render/base/frame_pair.h"

namespace gladstone::tracking {

/// Pair of frames of a sequence with equal intervals of time, with the frames before and after it, for particle tracks
/// over up to four frames.
class TrackFrames final : public FramePair {
 public:
  /// @param before, after  of the size of the pair; nullopt: missing
  TrackFrames(HostFrames pair, std::optional<Image<double>> before, std::optional<Image<double>> after)
      : pair_(std::move(pair)), before_(std::move(before)), after_(std::move(after)) {}
  Image<double> const& reference() const override { return pair_.reference(); }
  Image<double> const& flow() const override { return pair_.flow(); }
  std::optional<Image<double>> const& before() const { return before_; }
  std::optional<Image<double>> const& after() const { return after_; }

 private:
  HostFrames pair_;
  std::optional<Image<double>> before_, after_;
};

}  // namespace gladstone::tracking
