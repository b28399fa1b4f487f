#include "analysis/tracking/track_numbers.h"

#include <gtest/gtest.h>

namespace gladstone::inline tracking {
namespace {

using Numbers = std::vector<std::int64_t>;

/// Vectors of dots at places in frame A; NaN: no valid vector.
DisplacementField vectors(std::vector<Vec2d> const& places, std::vector<Vec2d> const& displacements) {
  DisplacementField field;
  for (std::size_t i = 0; i < places.size(); ++i) {
    bool const valid = is_finite(displacements[i]);
    field.position_px.push_back(valid ? places[i] + 0.5 * displacements[i] : places[i]);
    field.displacement_px.push_back(displacements[i]);
    field.status.push_back(valid ? VectorStatus::valid : VectorStatus::invalid);
  }
  return field;
}

Vec2d const none{std::nan(""), std::nan("")};

// Two particles cross the frames; the one that is lost in the second pair has a new number when it is found again, and
// so has a particle that enters. Numbers do not depend on the order of the vectors.
TEST(TrackNumbers, ContinueFromFrameBToFrameA) {
  TrackNumbers numbers(TrackNumbers::Continues::in_frame_b);
  EXPECT_EQ(numbers.number(vectors({{10, 10}, {30, 10}}, {{2, 1}, {3, 0}})), (Numbers{0, 1}));
  EXPECT_EQ(numbers.number(vectors({{33, 10}, {12, 11}, {50, 50}}, {{3, 0}, none, {1, 1}})), (Numbers{1, 0, 2}));
  EXPECT_EQ(numbers.number(vectors({{14, 12}, {36, 10}, {51, 51}}, {{2, 1}, {3, 0}, {1, 1}})), (Numbers{3, 1, 2}));
}

TEST(TrackNumbers, EndWhereAPairIsMissing) {
  TrackNumbers numbers(TrackNumbers::Continues::in_frame_b);
  EXPECT_EQ(numbers.number(vectors({{10, 10}}, {{2, 1}})), (Numbers{0}));
  numbers.end_tracks();
  EXPECT_EQ(numbers.number(vectors({{12, 11}}, {{2, 1}})), (Numbers{1}));
}

// With one reference, a dot has the same number in all pairs, valid or not.
TEST(TrackNumbers, AreThoseOfTheDotsOfACommonReference) {
  TrackNumbers numbers(TrackNumbers::Continues::in_frame_a);
  EXPECT_EQ(numbers.number(vectors({{10, 10}, {30, 10}}, {{2, 1}, none})), (Numbers{0, 1}));
  numbers.end_tracks();
  EXPECT_EQ(numbers.number(vectors({{10, 10}, {30, 10}}, {none, {5, 5}})), (Numbers{0, 1}));
  EXPECT_EQ(numbers.number(vectors({{10, 10}, {30, 10}}, {{-2, 1}, {5, 5}})), (Numbers{0, 1}));
}

}  // namespace
}  // namespace gladstone::inline tracking
