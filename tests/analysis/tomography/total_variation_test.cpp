#include "analysis/tomography/total_variation.h"

#include <gtest/gtest.h>

#include <numeric>

namespace gladstone::inline tomography {
namespace {

RegularGrid make_voxels(int nodes) { return {{nodes, nodes, nodes}, {1e-3, 1e-3, 1e-3}, {}}; }

// The total variation of a step of height h across a plane of n x n nodes is n^2 h.
TEST(TotalVariation, OfAStepIsItsHeightTimesItsArea) {
  RegularGrid const grid = make_voxels(6);
  std::vector<double> step(grid.size());
  for (std::size_t i = 0; i < step.size(); ++i) step[i] = i % 6 < 3 ? 0.0 : 0.25;
  EXPECT_NEAR(TotalVariation(grid).compute(step), 36 * 0.25, 1e-12);
}

// Denoising a step of two halves of width w moves each half by lambda / w towards the other (Strong & Chan 2003): the
// step stays a step, its height shrinks by 2 lambda / w, and the mean is conserved.
TEST(TotalVariation, DenoisingKeepsAnEdgeAndShrinksItsHeight) {
  RegularGrid const grid = make_voxels(6);
  std::vector<double> step(grid.size());
  for (std::size_t i = 0; i < step.size(); ++i) step[i] = i % 6 < 3 ? 0.0 : 1.0;
  double const lambda = 0.06;
  TotalVariation(grid).denoise(step, lambda, 3000);
  // The dual iteration converges like 1 / iterations in the energy, so that the error of x is far below lambda / 3
  for (std::size_t i = 0; i < step.size(); ++i)
    EXPECT_NEAR(step[i], i % 6 < 3 ? lambda / 3 : 1.0 - lambda / 3, 1e-3 * lambda);
  EXPECT_NEAR(std::accumulate(step.begin(), step.end(), 0.0), 0.5 * 216, 1e-9);
}

// A constant volume has no variation, and denoising leaves it exactly.
TEST(TotalVariation, LeavesAConstant) {
  RegularGrid const grid = make_voxels(4);
  std::vector<double> constant(grid.size(), 0.7);
  TotalVariation denoiser(grid);
  EXPECT_EQ(denoiser.compute(constant), 0.0);
  denoiser.denoise(constant, 0.1, 10);
  for (double const value : constant) EXPECT_EQ(value, 0.7);
}

// The spacing along each axis is relative to the shortest one: twice the spacing halves the difference.
TEST(TotalVariation, AccountsForTheSpacing) {
  RegularGrid grid = make_voxels(4);
  grid.spacing.z = 2e-3;
  std::vector<double> ramp(grid.size());
  for (std::size_t i = 0; i < ramp.size(); ++i) ramp[i] = static_cast<double>(i / 16);
  EXPECT_NEAR(TotalVariation(grid).compute(ramp), 16 * 3 * 0.5, 1e-12);
}

}  // namespace
}  // namespace gladstone::inline tomography
