#include "analysis/stereo/residual_validation.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "tests/analysis/stereo/inclined_camera.h"

namespace gladstone::inline stereo {
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

/// Vectors of particles at rest on 21 x 21 nodes 16 px apart, with a standard uncertainty of 0.1 px.
DisplacementField vectors_at_rest() {
  DisplacementField field;
  field.columns = field.rows = 21;
  for (int j = -10; j <= 10; ++j)
    for (int i = -10; i <= 10; ++i) field.position_px.push_back({256.0 + 16 * i, 256.0 + 16 * j});
  field.displacement_px.assign(field.size(), {});
  field.sigma_px.assign(field.size(), {0.1, 0.1});
  return field;
}

/// Vectors of two cameras at 45 degrees, that of the first in the middle of the image wrong by this displacement [px].
StereoField measure_with_outlier(Vec2d outlier_px) {
  DisplacementField a = vectors_at_rest();
  DisplacementField const b = a;
  a.displacement_px[a.size() / 2] = outlier_px;
  return reject_large_residuals(
      reconstruct({inclined_camera(-45), {}}, a, {inclined_camera(45), {}}, b, {}, {.spacing = 2e-3}), 4.0);
}

// A wrong v of one camera leaves a residual of 3 px / sqrt(2), 21 standard uncertainties. Interpolation spreads it over
// two distances of the vectors, 3.2 mm along Y and 4.5 mm along X: 5.6 mm at most. A wrong u changes w, but leaves no
// residual.
TEST(ResidualValidation, RejectsNodesNextToAnOutlierOfV) {
  StereoField const wrong_v = measure_with_outlier({0, 3}), wrong_u = measure_with_outlier({3, 0});
  EXPECT_EQ(count_rejected(wrong_u), 0u);
  std::size_t far = 0;
  for (std::size_t i = 0; i < wrong_v.nodes.size(); ++i) {
    if (!wrong_v.nodes[i]) continue;
    double const distance = length(wrong_v.grid.position(i));
    if (distance < 1e-9) {
      EXPECT_EQ(wrong_v.nodes[i]->status, VectorStatus::invalid);
      EXPECT_GT(std::abs(wrong_u.nodes[i]->displacement.z), 1e-4) << "above 1 px";
    }
    if (distance < 6e-3) continue;
    ++far;
    EXPECT_EQ(wrong_v.nodes[i]->status, VectorStatus::valid);
  }
  EXPECT_GT(far, 50u);
}

}  // namespace
}  // namespace gladstone::inline stereo
