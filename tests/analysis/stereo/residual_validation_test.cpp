#include "analysis/stereo/residual_validation.h"

#include <gtest/gtest.h>

#include <limits>
#include <optional>
#include <utility>
#include <vector>

namespace gladstone::stereo {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Nodes with these residuals [px] and their ratios to the standard uncertainty, and one that was not determined.
StereoField field_of(std::vector<std::pair<double, double>> const& residuals) {
  StereoField field;
  field.grid = {static_cast<int>(residuals.size()) + 1, 1, {}, 1e-3};
  for (auto const& [residual_px, ratio] : residuals) {
    StereoVector vector{};
    vector.residual_px = residual_px;
    vector.residual_ratio = ratio;
    field.nodes.emplace_back(vector);
  }
  field.nodes.emplace_back(std::nullopt);
  return field;
}

std::vector<bool> accepted(StereoField const& field) {
  std::vector<bool> valid;
  for (auto const& node : field.nodes)
    if (node) valid.push_back(node->status == VectorStatus::valid);
  return valid;
}

TEST(ResidualValidation, RejectsResidualsAboveTheLimit) {
  StereoField const field = field_of({{0.3, 3.0}, {0.5, 5.0}, {0.39, 3.9}, {4.1, 4.1}});
  StereoField const checked = reject_large_residuals(field, 4.0);
  EXPECT_EQ(accepted(checked), (std::vector{true, false, true, false}));
  EXPECT_EQ(count_rejected(checked), 2u);
  EXPECT_EQ(count_rejected(reject_large_residuals(field, 2.0)), 4u);
  EXPECT_EQ(count_rejected(reject_large_residuals(field, 0.0)), 0u) << "no validation";
}

TEST(ResidualValidation, AcceptsTheUsualFluctuationOfCorrelatedVectors) {
  EXPECT_EQ(count_rejected(reject_large_residuals(field_of({{0.099, 9.0}, {0.101, 9.0}}), 4.0)), 1u);
}

// The median of 0.2, 0.2, 0.2, 0.2, 1.1, 1.3 is 0.2, that of a normal distribution with the standard deviation
// 0.2 / 0.6745 = 0.297 px, four of which are 1.19 px. Medians below 0.1 px count as 0.1 px, which rejects from 0.4 px.
TEST(ResidualValidation, EstimatesTheUncertaintyOfVectorsWithoutIt) {
  StereoField const noisy = field_of({{0.2, nan}, {0.2, nan}, {0.2, nan}, {0.2, nan}, {1.1, nan}, {1.3, nan}});
  EXPECT_EQ(accepted(reject_large_residuals(noisy, 4.0)), (std::vector{true, true, true, true, true, false}));
  StereoField const clean = field_of({{1e-3, nan}, {1e-3, nan}, {1e-3, nan}, {0.39, nan}, {0.41, nan}});
  EXPECT_EQ(accepted(reject_large_residuals(clean, 4.0)), (std::vector{true, true, true, true, false}));
}

}  // namespace
}  // namespace gladstone::stereo
