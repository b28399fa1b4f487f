#pragma once

#include <optional>
#include <utility>

#include "analysis/vectors/displacement_field.h"
#include "render/base/frame_pair.h"

namespace gladstone::inline tracking {

/// Pair of frames of a sequence with equal intervals of time, with the frames before and after it, for particle tracks
/// over up to four frames.
class TrackFrames final : public StoredFrames {
 public:
  /// @param before,  after frames before and after the pair, of the same size as the pair; nullopt: missing
  /// @param dots           receives the scattered vectors of a tracking correlator; null: not requested
  TrackFrames(HostFrames pair, std::optional<Image<double>> before, std::optional<Image<double>> after,
              DisplacementField* dots = nullptr)
      : pair_(std::move(pair)), before_(std::move(before)), after_(std::move(after)), dots_(dots) {}
  Image<double> const& reference() const override { return pair_.reference(); }
  Image<double> const& flow() const override { return pair_.flow(); }
  std::optional<Image<double>> const& before() const { return before_; }
  std::optional<Image<double>> const& after() const { return after_; }
  DisplacementField* dots() const { return dots_; }

 private:
  HostFrames pair_;
  std::optional<Image<double>> before_, after_;
  DisplacementField* dots_;
};

}  // namespace gladstone::inline tracking
