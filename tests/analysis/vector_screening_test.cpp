#include "analysis/vectors/vector_screening.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "analysis/vectors/vector_file.h"
#include "tests/support/numbers_in.h"

namespace gladstone {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();
constexpr double infinity = std::numeric_limits<double>::infinity();
constexpr int columns = 200, rows = 100;

/// A lattice of 11 x 5 vectors of (1, 2) px that fills the image; the peak ratio of each is its index.
DisplacementField lattice() {
  DisplacementField field;
  for (int row = 0; row < 5; ++row) {
    for (int column = 0; column < 11; ++column) {
      field.position_px.push_back({15.5 + 16.0 * column, 15.5 + 16.0 * row});
      field.displacement_px.push_back({1.0, 2.0});
      field.peak_ratio.push_back(static_cast<double>(field.peak_ratio.size()));
      field.status.push_back(VectorStatus::valid);
    }
  }
  arrange_as_grid(field);
  return field;
}

TEST(ScreenVectors, LeavesGoodOnesAsTheyAre) {
  DisplacementField field = lattice();
  RejectedVectors const left_out = screen_vectors(field, 0.0, columns, rows);
  EXPECT_EQ(left_out.all(), 0u);
  EXPECT_THAT(left_out.text(), IsEmpty());
  EXPECT_EQ(field.columns, 11);
  EXPECT_EQ(field.rows, 5);
  EXPECT_THAT(reason_to_reject_positions(field, left_out, columns, rows), IsEmpty());
  EXPECT_THAT(describe_suspect_positions(field, columns, rows), IsEmpty());
}

// Three duplicate rows of a file would count twice in every mean.
TEST(ScreenVectors, RefusesVectorsGivenTwice) {
  DisplacementField field = lattice();
  for (std::size_t const i : {2u, 17u, 40u}) {
    field.position_px.push_back(field.position_px[i]);
    field.displacement_px.push_back(field.displacement_px[i]);
    field.peak_ratio.push_back(field.peak_ratio[i]);
    field.status.push_back(VectorStatus::valid);
  }
  RejectedVectors const left_out = screen_vectors(field, 0.0, columns, rows);
  EXPECT_THAT(reason_to_reject_positions(field, left_out, columns, rows),
              AllOf(HasSubstr("3 of 58"), HasSubstr("(47.5, 15.5) px")));
}

TEST(ScreenVectors, TakesImpossiblePlacesOutAndCountsThem) {
  DisplacementField field = lattice();
  field.position_px[3].x = nan;
  field.position_px[4].y = -infinity;
  field.position_px[5].x = 1e15;
  field.position_px[6].y = -1e308;
  field.position_px[7].x = columns + 1.5;  // 2.5 px beyond the last pixel's centre
  field.position_px[8].x = columns + 0.5;  // 1.5 px: another origin of pixel coordinates
  RejectedVectors const left_out = screen_vectors(field, 0.0, columns, rows);
  EXPECT_EQ(left_out.place_not_finite, 2u);
  EXPECT_EQ(left_out.outside_image, 3u);
  EXPECT_EQ(left_out.all(), 5u);
  ASSERT_EQ(field.size(), 50u);
  EXPECT_EQ(field.peak_ratio[2], 2.0);
  EXPECT_EQ(field.peak_ratio[3], 8.0) << "what belongs to a vector stays with it";
  EXPECT_THAT(numbers_in(left_out.text()), testing::ElementsAre(2, 3, 2))
      << "2 without a position, and 3 that are more than 2 px outside the image";
}

// The image is 200 x 100 px: a displacement of 200 px crosses it, one of 201 px cannot be observed.
TEST(ScreenVectors, MarksImpossibleDisplacementsInvalidAndKeepsTheirPlaces) {
  DisplacementField field = lattice();
  field.displacement_px[0].x = 1e308;
  field.displacement_px[1].x = 201.0;
  field.displacement_px[2].x = 200.0;
  field.displacement_px[3].y = -101.0;
  field.displacement_px[4] = {nan, 0.0};
  field.displacement_px[5] = {nan, nan};
  field.status[5] = VectorStatus::masked;
  RejectedVectors const left_out = screen_vectors(field, 0.0, columns, rows);
  EXPECT_EQ(left_out.displacement_beyond_image, 3u);
  EXPECT_EQ(left_out.displacement_not_finite, 1u) << "a masked vector has none";
  EXPECT_EQ(field.columns, 11);
  for (std::size_t const i : {0u, 1u, 3u, 4u}) {
    EXPECT_EQ(field.status[i], VectorStatus::invalid) << i;
    EXPECT_TRUE(std::isnan(field.displacement_px[i].x)) << i;
  }
  EXPECT_EQ(field.status[2], VectorStatus::valid);
  EXPECT_EQ(field.status[5], VectorStatus::masked);
}

TEST(ScreenVectors, AddsTheSpecifiedOffset) {
  DisplacementField field = lattice();
  for (Vec2d& p : field.position_px) p += Vec2d{1000.0, 1000.0};
  EXPECT_EQ(screen_vectors(field, -1000.0, columns, rows).all(), 0u);
}

TEST(ScreenVectors, ReportsPositionsIfAllVectorsAreRejected) {
  DisplacementField field = lattice();
  for (Vec2d& p : field.position_px) p = 100.0 * p;
  field.position_px[0].x = nan;
  RejectedVectors const left_out = screen_vectors(field, 0.0, columns, rows);
  EXPECT_EQ(field.size(), 0u);
  EXPECT_THAT(reason_to_reject_positions(field, left_out, columns, rows),
              AllOf(HasSubstr("200 x 100 px"), HasSubstr("1550"), HasSubstr("17550"), HasSubstr("7950")));
}

// Counted from another corner: half of the grid of 5 x 11 vectors is outside.
TEST(ScreenVectors, RefusesAFileWhoseVectorsLieMostlyOutside) {
  DisplacementField field = lattice();
  for (Vec2d& p : field.position_px) p.x += 120.0;
  RejectedVectors const left_out = screen_vectors(field, 0.0, columns, rows);
  ASSERT_GT(field.size(), 0u);
  EXPECT_THAT(reason_to_reject_positions(field, left_out, columns, rows), HasSubstr("200 x 100 px"));
}

// Windows every 16 px of 10 um are 0.16 mm apart: 55 vectors on 1.6 x 0.64 "px".
TEST(ScreenVectors, RefusesPlacesCloserThanPixels) {
  DisplacementField field = lattice();
  for (Vec2d& p : field.position_px) p = 0.01 * p;
  RejectedVectors const left_out = screen_vectors(field, 0.0, columns, rows);
  EXPECT_THAT(reason_to_reject_positions(field, left_out, columns, rows), testing::Not(IsEmpty()));
}

TEST(ScreenVectors, DoubtsPlacesThatCrowdInACorner) {
  DisplacementField field = lattice();
  for (Vec2d& p : field.position_px) p = 0.1 * p;  // 16 x 6.4 px are 0.5 % of the image
  RejectedVectors const left_out = screen_vectors(field, 0.0, columns, rows);
  EXPECT_THAT(reason_to_reject_positions(field, left_out, columns, rows), IsEmpty());
  EXPECT_THAT(describe_suspect_positions(field, columns, rows), HasSubstr("0.51 %"));
}

}  // namespace
}  // namespace gladstone
