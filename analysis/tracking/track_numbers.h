#pragma once

#include <cstdint>
#include <vector>

#include "analysis/vectors/displacement_field.h"

namespace gladstone::inline tracking {

/// Numbers the tracks of dots and particles through the pairs of a sequence.
class TrackNumbers {
 public:
  /// Frame in which a track continues in the next pair.
  enum class Continues {
    in_frame_b,  ///< frame B of a pair is frame A of the next one: a track ends without a valid vector
    in_frame_a,  ///< all pairs have the same frame A, whose dots retain their numbers
  };
  explicit TrackNumbers(Continues continues) : continues_(continues) {}

  /// Numbers the vectors of the next pair, from 0. A dot belongs to the track that ends within 0.1 px of its place in
  /// frame A: the fits of a frame in two pairs can differ only if the masks of the pairs differ.
  /// @param dots  scattered vectors as returned by matched_vectors()
  std::vector<std::int64_t> number(DisplacementField const& dots);

  /// Ends all tracks where a pair is missing, unless all pairs have the same frame A.
  void end_tracks();

 private:
  Continues continues_;
  std::int64_t next_ = 0;
  std::vector<Vec2d> ends_;  ///< places at which the tracks of the previous pair continue [px]
  std::vector<std::int64_t> numbers_;
};

}  // namespace gladstone::inline tracking
