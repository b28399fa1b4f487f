#include "studies/compare/stereo_truth.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "studies/compare/stereo_warnings.h"

namespace gladstone {
namespace {

/// Particles in a sheet with the light exp(-8 z^2 / t^2), whose e^-2 width is t; both cameras receive the same light.
GroundTruth particles_of_a_sheet(double thickness, std::size_t count) {
  constexpr double slope = 0.05, curvature = 100.0;  // u = 0.1 mm + slope z [1], w = curvature z^2 [1/m]
  GroundTruth truth;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> place(-4e-3, 4e-3), depth(-1.5 * thickness, 1.5 * thickness);
  for (std::size_t i = 0; i < count; ++i) {
    Vec3d const middle{place(random), place(random), depth(random)};
    Vec3d const moved{1e-4 + slope * middle.z, -2e-4, curvature * middle.z * middle.z};
    truth.position_m.push_back(middle - 0.5 * moved);
    truth.particles.second_m.push_back(middle + 0.5 * moved);
    double const light = std::exp(-8.0 * middle.z * middle.z / (thickness * thickness));
    truth.flux.push_back({light, light});
  }
  return truth;
}

// The truth at a node is the mean over the thickness of the sheet, weighted by the squared light exp(-16 z^2 / t^2),
// the weight of a particle in the correlation: z has the mean 0 and the variance t^2 / 32. With t = 2 mm, u is 0.1 mm
// and w is 100 / m * 0.125 mm^2 = 0.0125 mm. About 800 particles count in a window of 2.4 mm: the standard error of the
// mean of z is 0.35 mm / sqrt(800) = 0.0125 mm, and that of z^2 sqrt(2) times 0.125 mm^2 / sqrt(800). Limits: 4
// standard errors.
TEST(StereoTruth, IsTheMeanOverTheThicknessOfTheSheet) {
  GroundTruth const dots = particles_of_a_sheet(2e-3, 60'000);
  stereo::NodeGrid const grid = stereo::NodeGrid::between({-1e-3, -1e-3}, {1e-3, 1e-3}, 1e-3);
  CorrelationSettings settings;
  settings.window_px = {24};
  std::vector<Vec3d> const truth = compute_stereo_truth({&dots, &dots}, {1e4, 1e4}, grid, settings);
  ASSERT_EQ(truth.size(), 9u);
  for (Vec3d const& at : truth) {
    EXPECT_NEAR(at.x, 1e-4, 4 * 0.05 * 0.0125e-3);
    EXPECT_NEAR(at.y, -2e-4, 1e-15);
    EXPECT_NEAR(at.z, 1.25e-5, 4 * std::sqrt(2.0) * 1.25e-5 / std::sqrt(800.0));
  }
}

// A plane is corrected only if its first disparity is significant and its last one small.
TEST(StereoAlignment, OfAnUnfinishedIterationIsNotUsed) {
  StereoMeasurement measurement;
  EXPECT_FALSE(measurement.is_aligned());
  stereo::SheetAlignment alignment;
  alignment.disparity_sigma_px = 0.02;
  auto const is_aligned = [&](std::vector<double> const& disparity_px) {
    alignment.disparity_px = disparity_px;
    measurement.alignment = alignment;
    return measurement.is_aligned();
  };
  auto const warns = [&] {
    for (Warning const& warning : find_stereo_warnings(measurement))
      if (warning.code == WarningCode::low_accuracy) return true;
    return false;
  };
  EXPECT_TRUE(is_aligned({4.0, 0.3, 0.004}));
  EXPECT_FALSE(warns());
  EXPECT_FALSE(is_aligned({4.0, 2.0, 1.5}));
  EXPECT_TRUE(warns());
  EXPECT_FALSE(is_aligned({0.05, 0.004})) << "less than three standard uncertainties";
  EXPECT_FALSE(warns());
}

}  // namespace
}  // namespace gladstone
