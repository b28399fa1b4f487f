#include "studies/sweep/ranking.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace gladstone {
namespace {

/// A study of three f-numbers with two repeats. The error in pixels is smallest at f/8, the error over the signal at
/// f/16, and that of the gradient at f/32.
StudyTable three_stops() {
  StudyTable table;
  table.axes = {{"lens.f_number", true, {"8", "16", "32"}, {8, 16, 32}}};
  table.measures = {"eq9.rms_px", "error_over_signal", "gradient_error_kg_m4"};
  double const measures[3][3] = {{0.01, 0.30, 5}, {0.02, 0.10, 4}, {0.03, 0.20, 3}};
  table.points.resize(3);
  for (std::size_t i = 0; i < 6; ++i) {
    StudyRow row;
    row.index = i;
    row.repeat = i / 3;
    row.status = CaseStatus::ok;
    row.value = {i % 3};
    row.measures.assign(measures[i % 3], measures[i % 3] + 3);
    table.points[i % 3].rows.push_back(i);
    table.rows.push_back(row);
  }
  return table;
}

TEST(Ranking, OrdersPointsByEachMeasure) {
  auto const rankings = rank_points(three_stops());
  ASSERT_EQ(rankings.size(), 3u);
  EXPECT_EQ(rankings[0].measure, "eq9.rms_px");
  EXPECT_EQ(rankings[0].points.front().row, 0u);
  EXPECT_EQ(rankings[1].points.front().row, 1u);
  EXPECT_EQ(rankings[2].points.front().row, 2u);
  EXPECT_NEAR(rankings[1].points.front().value, 0.10, 1e-15);
}

// The mean over the finished repeats counts: 0.01 and 0.07 px of f/8 are more than 0.02 and 0.02 px of f/16.
TEST(Ranking, AveragesOverFinishedRepeats) {
  StudyTable table = three_stops();
  table.rows[3].measures[0] = 0.07;
  EXPECT_EQ(rank_points(table)[0].points.front().row, 1u);
  table.rows[3].status = CaseStatus::failed;
  EXPECT_EQ(rank_points(table)[0].points.front().row, 0u);
}

TEST(Ranking, LeavesOutWhatIsUnknown) {
  StudyTable table = three_stops();
  for (StudyRow& row : table.rows) row.measures[2] = std::nan("");
  table.rows[1].measures[1] = table.rows[4].measures[1] = std::nan("");
  auto const rankings = rank_points(table);
  ASSERT_EQ(rankings.size(), 2u);
  ASSERT_EQ(rankings[1].points.size(), 2u);
  EXPECT_EQ(rankings[1].points.front().row, 2u);
  EXPECT_TRUE(rank_points(StudyTable{}).empty());
}

TEST(Ranking, NamesThePointsInTextAndJson) {
  StudyTable const table = three_stops();
  auto const rankings = rank_points(table);
  EXPECT_THAT(ranking_text(table, rankings), testing::HasSubstr("lens.f_number = 16"));
  auto const json = ranking_json(table, rankings);
  EXPECT_EQ(json[2]["points"][0]["case"], 2);
  EXPECT_EQ(json[2]["points"].size(), 3u);
}

}  // namespace
}  // namespace gladstone
