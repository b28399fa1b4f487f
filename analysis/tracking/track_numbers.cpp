#include "analysis/tracking/track_numbers.h"

#include <utility>

#include "analysis/tracking/nearest_points.h"

namespace gladstone::inline tracking {
namespace {

constexpr double same_place = 0.1;  // distance below which two positions belong to the same dot [px]

}  // namespace

std::vector<std::int64_t> TrackNumbers::number(DisplacementField const& dots) {
  NearestPoints const known(ends_);
  std::vector<std::int64_t> numbers;
  std::vector<Vec2d> ends;
  std::vector<std::int64_t> numbers_of_ends;
  for (std::size_t i = 0; i < dots.size(); ++i) {
    // Valid vectors are at the mid-position of their dot, other vectors at the dot's position in frame A.
    bool const valid = dots.counts(i);
    Vec2d const half = valid ? 0.5 * dots.displacement_px[i] : Vec2d{};
    std::vector<std::size_t> const same = known.within(dots.position_px[i] - half, same_place);
    numbers.push_back(same.empty() ? next_++ : numbers_[same.front()]);
    if (!valid && continues_ == Continues::in_frame_b) continue;
    ends.push_back(continues_ == Continues::in_frame_b ? dots.position_px[i] + half : dots.position_px[i] - half);
    numbers_of_ends.push_back(numbers.back());
  }
  ends_ = std::move(ends);
  numbers_ = std::move(numbers_of_ends);
  return numbers;
}

void TrackNumbers::end_tracks() {
  if (continues_ == Continues::in_frame_a) return;
  ends_.clear();
  numbers_.clear();
}

}  // namespace gladstone::inline tracking
