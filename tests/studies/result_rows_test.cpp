#include "studies/case/result_rows.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace gladstone {
namespace {

using ::testing::HasSubstr;

std::vector<ResultRow> rows() {
  return {{.key = "focal_length_mm", .symbol = "f", .label = "focal length", .value = 105, .unit = "mm"},
          {.key = "pupil_mm.diameter", .label = "pupil, diameter", .value = HUGE_VAL, .unit = "mm"},
          {.key = "pupil_mm.position",
           .label = "pupil, \"position\"",
           .value = std::nan(""),
           .unit = "mm",
           .source = "Born, Wolf",
           .margin = Margin::violated,
           .note = "no stop"}};
}

TEST(ResultRows, AreTextWithSymbolUnitMarginAndNote) {
  std::string const text = rows_text(rows());
  EXPECT_THAT(text, testing::ContainsRegex("focal length, f +105 mm\n"));
  EXPECT_THAT(text, testing::ContainsRegex("pupil, diameter +infinite\n"));
  EXPECT_THAT(text, testing::ContainsRegex("position. +unknown  .violated.  .no stop.\n"));
}

TEST(ResultRows, AreAlignedIfALabelIsLong) {
  std::string const label(60, 'x');
  std::string const text = rows_text(
      {{.key = "a", .label = label, .value = 1, .margin = Margin::green}, {.key = "b", .label = "short", .value = 2}});
  EXPECT_EQ(text, "  " + label + " 1  [ok]\n  short" + std::string(56, ' ') + "2\n");
}

TEST(ResultRows, AreJsonWhoseKeysWithPointsAreObjects) {
  nlohmann::ordered_json const expected{{"focal_length_mm", 105.0},
                                        {"pupil_mm", {{"diameter", nullptr}, {"position", nullptr}}}};
  EXPECT_EQ(rows_json(rows()), expected);
  EXPECT_EQ(rows_json({}), nlohmann::ordered_json::object());
}

TEST(ResultRows, AreIntegersAndArraysWhereTheRowsSaySo) {
  nlohmann::ordered_json const json =
      rows_json({{.key = "nodes.0", .label = "nodes along x", .value = 6, .whole = true},
                 {.key = "nodes.1", .label = "nodes along y", .value = 5, .whole = true},
                 {.key = "spacing.0", .label = "spacing along x", .value = 1}});
  EXPECT_EQ(json.dump(), R"({"nodes":[6,5],"spacing":[1.0]})");
}

TEST(ResultRows, CountsHaveAllDigits) {
  std::vector<ResultRow> const counts{count_row("vectors", "vectors", 12'345'678)};
  EXPECT_THAT(rows_text(counts), HasSubstr(" 12345678\n"));
  EXPECT_EQ(rows_json(counts).dump(), R"({"vectors":12345678})");
}

// RFC 4180: fields with commas or quotes are quoted, and quotes are doubled.
TEST(ResultRows, AreCsvWithEveryColumn) {
  std::string const csv = rows_csv(rows());
  EXPECT_THAT(csv, testing::StartsWith("key,symbol,label,value,unit,source\n"));
  EXPECT_THAT(csv, HasSubstr("focal_length_mm,f,focal length,105,mm,\n"));
  EXPECT_THAT(csv, HasSubstr("pupil_mm.position,,\"pupil, \"\"position\"\"\",nan,mm,\"Born, Wolf\"\n"));
}

TEST(ResultRows, OfACameraAreMembersOfIt) {
  std::vector<ResultRow> all;
  append_rows(all, rows(), "left");
  append_rows(all, rows(), "");
  ASSERT_EQ(all.size(), 6u);
  EXPECT_EQ(all[0].key, "left.focal_length_mm");
  EXPECT_EQ(all[3].key, "focal_length_mm");
}

}  // namespace
}  // namespace gladstone
