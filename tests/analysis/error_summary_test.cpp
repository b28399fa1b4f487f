#include "analysis/errors/error_summary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <span>
#include <vector>

namespace gladstone {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

// Errors (1, 0), (-1, 0), (0.5, 0.5), (0.5, -0.5): bias (0.25, 0); variance u = (1 + 1 + .25 + .25)/4 - 1/16 = 9/16,
// v = 0.5/4; rms = sqrt(3/4/2).
TEST(ErrorSummary, IsThatOfPaperAndPencil) {
  std::vector<Vec2d> const truth(4, Vec2d{2.0, -3.0});
  std::vector<Vec2d> const measured{{3.0, -3.0}, {1.0, -3.0}, {2.5, -2.5}, {2.5, -3.5}};
  ErrorSummary const summary = summarize_errors(measured, truth, {});
  EXPECT_EQ(summary.count(), 4u);
  EXPECT_EQ(summary["valid_fraction"], 1.0);
  EXPECT_DOUBLE_EQ(summary["bias_u_px"], 0.25);
  EXPECT_DOUBLE_EQ(summary["bias_v_px"], 0.0);
  EXPECT_DOUBLE_EQ(summary["random_u_px"], 0.75);
  EXPECT_DOUBLE_EQ(summary["random_v_px"], std::sqrt(0.125));
  EXPECT_DOUBLE_EQ(summary["rms_px"], std::sqrt(0.375));
  EXPECT_EQ(summary["gross_fraction"], 0.0);  // a magnitude of exactly 1 px is not gross
}

// rms^2 = (bias_u^2 + bias_v^2 + random_u^2 + random_v^2)/2 holds exactly for population deviations. Each of the sums
// has 1000 terms of about 1, whose rounding errors of up to 1.1e-13 each change a mean by sqrt(1000) 1.1e-13/1000 =
// 4e-15.
TEST(ErrorSummary, RmsIsBiasAndRandomTogether) {
  std::vector<Vec2d> measured, truth;
  for (int i = 0; i < 1000; ++i) {
    measured.push_back({std::sin(1.3 * i) + 0.1, 0.3 * std::cos(0.7 * i)});
    truth.push_back({0.2 * std::cos(i), 0.1});
  }
  ErrorSummary const s = summarize_errors(measured, truth, {});
  double const square = s["bias_u_px"] * s["bias_u_px"] + s["bias_v_px"] * s["bias_v_px"] +
                        s["random_u_px"] * s["random_u_px"] + s["random_v_px"] * s["random_v_px"];
  EXPECT_NEAR(s["rms_px"] * s["rms_px"], 0.5 * square, 1e-14);
}

// 99 exact vectors and one wrong by (3, 4): rms = sqrt(25/100/2), without the gross error, the rms error is zero.
TEST(ErrorSummary, KeepsGrossErrorsApart) {
  std::vector<Vec2d> const truth(100, Vec2d{});
  std::vector<Vec2d> measured(100, Vec2d{});
  measured[17] = {3.0, 4.0};
  ErrorSummary const summary = summarize_errors(measured, truth, {});
  EXPECT_DOUBLE_EQ(summary["rms_px"], std::sqrt(0.125));
  EXPECT_EQ(summary["rms_without_gross_px"], 0.0);
  EXPECT_DOUBLE_EQ(summary["gross_fraction"], 0.01);
  EXPECT_EQ(summary["p95_px"], 0.0);
}

// Magnitudes 0..100: the 95th percentile is 95.
TEST(ErrorSummary, PercentileIsLinearBetweenOrderStatistics) {
  std::vector<Vec2d> measured, truth(101);
  for (int i = 0; i <= 100; ++i) measured.push_back({0.0, static_cast<double>((37 * i) % 101)});
  EXPECT_DOUBLE_EQ(summarize_errors(measured, truth, {})["p95_px"], 95.0);
  EXPECT_DOUBLE_EQ(quantile({1.0, 2.0}, 0.25), 1.25);
  EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

TEST(ErrorSummary, OfNothingIsNotANumber) {
  std::vector<Vec2d> const one(1, Vec2d{1.0, 1.0});
  ErrorSummary const masked = summarize_errors(one, one, {0});
  EXPECT_EQ(masked.count(), 0u);
  EXPECT_EQ(masked["valid_fraction"], 0.0);
  for (double const value : {masked["bias_u_px"], masked["random_v_px"], masked["rms_px"],
                             masked["rms_without_gross_px"], masked["p95_px"], masked["gross_fraction"]}) {
    EXPECT_TRUE(std::isnan(value));
  }
  EXPECT_TRUE(std::isnan(summarize_errors({}, {}, {})["valid_fraction"]));
}

// Their names and order are those of docs/file-formats.md (DocumentedNames).
TEST(ErrorMeasures, OfACaseHaveTheValuesOfTheSummary) {
  std::vector<Vec2d> const truth(2), measured{{0.25, 0.0}, {0.0, 0.5}};
  auto const rows = error_measures(measured, truth, {1, 1}, 4);
  std::map<std::string_view, double> const values(rows.begin(), rows.end());
  EXPECT_EQ(values.size(), rows.size());
  EXPECT_EQ(values.at("count"), 2.0);
  EXPECT_EQ(values.at("valid_fraction"), 0.5);
  EXPECT_EQ(values.at("rms_px"), summarize_errors(measured, truth, {})["rms_px"]);
  EXPECT_FALSE(values.contains("gross")) << "a number of the benchmark";
}

TEST(CommonMask, NeedsAValidStatusAndFiniteNumbersEverywhere) {
  DisplacementField field;
  field.displacement_px = {{1, 1}, {1, 1}, {1, 1}, {1, 1}, {nan, 1}, {1, 1}};
  field.position_px.resize(6);
  field.status = {VectorStatus::valid,   VectorStatus::replaced, VectorStatus::masked,
                  VectorStatus::invalid, VectorStatus::valid,    VectorStatus::valid};
  std::vector<Vec2d> reference(6);
  reference[5] = {0.0, nan};
  std::vector<std::span<Vec2d const>> const references{reference, {}};
  EXPECT_EQ(common_mask(field, references), (VectorMask{1, 1, 0, 0, 0, 0}));
}

}  // namespace
}  // namespace gladstone
