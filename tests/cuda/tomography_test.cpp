#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "analysis/tomography/volume_reconstruction.h"
#include "cuda/backend.h"
#include "render/base/not_a_number.h"
#include "tests/analysis/tomography/phantom_views.h"

namespace gladstone::inline tomography {
namespace {

constexpr double width = 20e-3, radius = 4e-3;

class CudaTomography : public testing::Test {
 protected:
  void SetUp() override {
    if (cuda::DeviceState const state = cuda::device_state(); !state.usable) GTEST_SKIP() << state.text;
  }
};

/// Turns the parallel lines of a view into lines that meet in a pupil, through the same points of the middle plane.
void converge(ProjectedView& view, double pupil_distance) {
  Vec3d const along = view.lines.front().direction;
  for (SightLine& line : view.lines) {
    Vec3d const pupil = pupil_distance * along;
    line.direction = normalized(pupil - line.origin);
    line.origin = line.origin - 0.25 * line.direction;
    line.pupil_distance = length(pupil - line.origin);
    line.scale = (line.pupil_distance - 0.25) / 0.25;
  }
}

/// Views with unmeasured lines, of a blob that is not at the middle of the volume. The number of nodes is not a
/// multiple of the number of nodes of a tile.
std::vector<ProjectedView> make_views(bool parallel) {
  std::vector<ProjectedView> views = view_blob(5, 27, width, radius, {2e-3, -1e-3, 1.5e-3});
  for (ProjectedView& view : views) {
    if (!parallel) converge(view, 0.6);
    for (std::size_t i = 0; i < view.value.size(); i += 37) view.value[i] = not_a_number;
  }
  return views;
}

/// Compares the volumes of both devices. Both use the same function objects and add the contributions to a node in the
/// same order. They differ by fused products and by the order of the sums over all nodes and lines: rounding of 1e-16
/// relative in each of some ten operations of a node and sweep. No step amplifies a difference: the mean of the
/// residuals has the weights of the volume, and denoising is not expansive.
void expect_equal(std::vector<ProjectedView> const& views, RegularGrid const& grid, SartSettings const& settings) {
  VolumeReconstruction const cpu = reconstruct_volume(views, grid, settings);
  VolumeReconstruction const gpu = reconstruct_volume(views, grid, settings, cuda::make_volume);
  EXPECT_EQ(cpu.device, "cpu");
  EXPECT_EQ(gpu.device, "cuda");
  EXPECT_EQ(cpu.views, gpu.views);
  ASSERT_EQ(cpu.residual.size(), gpu.residual.size());
  for (std::size_t i = 0; i < cpu.residual.size(); ++i)
    EXPECT_NEAR(gpu.residual[i], cpu.residual[i], 1e-12 * cpu.residual.front());
  double largest = 0.0;
  for (double const value : cpu.value) largest = std::max(largest, std::abs(value));
  for (std::size_t i = 0; i < cpu.value.size(); ++i) ASSERT_NEAR(gpu.value[i], cpu.value[i], 1e-12 * largest) << i;
  ASSERT_EQ(cpu.view_residual.size(), gpu.view_residual.size());
  for (std::size_t i = 0; i < cpu.view_residual.size(); ++i)
    EXPECT_NEAR(gpu.view_residual[i], cpu.view_residual[i], 1e-12);
  EXPECT_NEAR(gpu.tv_weight, cpu.tv_weight, 1e-12);
  EXPECT_LT(compute_relative_error(gpu.value, cpu.value), 1e-12);
}

TEST_F(CudaTomography, EqualsTheCpuForParallelLines) {
  SartSettings settings;
  settings.iterations = 12;
  expect_equal(make_views(true), make_cube(27, width), settings);
}

TEST_F(CudaTomography, EqualsTheCpuForALensWithBoundsAndSupport) {
  RegularGrid grid = make_cube(21, width);
  grid.nodes = {21, 18, 25};
  grid.spacing.z = 0.8e-3;
  SartSettings settings;
  settings.iterations = 8;
  settings.lowest = 0.0;
  settings.highest = 0.8;
  for (double const value : sample_blob(grid, 2.0 * radius)) settings.support.push_back(value > 0.1 ? 1 : 0);
  expect_equal(make_views(false), grid, settings);
}

TEST_F(CudaTomography, EqualsTheCpuWithAndWithoutAFixedWeight) {
  SartSettings settings;
  settings.iterations = 5;
  for (double const weight : {0.0, 0.02}) {
    settings.tv_weight = weight;
    expect_equal(make_views(true), make_cube(20, width), settings);
  }
}

// No sum depends on the order of execution.
TEST_F(CudaTomography, IsTheSameEveryTime) {
  SartSettings settings;
  settings.iterations = 5;
  auto const views = make_views(false);
  RegularGrid const grid = make_cube(33, width);
  VolumeReconstruction const first = reconstruct_volume(views, grid, settings, cuda::make_volume);
  VolumeReconstruction const again = reconstruct_volume(views, grid, settings, cuda::make_volume);
  EXPECT_EQ(first.value, again.value);
  EXPECT_EQ(first.residual, again.residual);
}

}  // namespace
}  // namespace gladstone::inline tomography
