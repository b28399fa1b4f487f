#include "analysis/tomography/volume_reconstruction.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "render/base/error.h"
#include "render/base/not_a_number.h"
#include "render/base/parallel.h"
#include "tests/analysis/tomography/phantom_views.h"
#include "tests/support/expect_error.h"

namespace gladstone::inline tomography {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::IsEmpty;
using testing::Not;

constexpr double width = 20e-3, radius = 4e-3;
constexpr int nodes = 21;

SartSettings quick_settings() {
  SartSettings settings;
  settings.iterations = 30;
  return settings;
}

VolumeReconstruction reconstruct_blob(int views, Vec3d centre = {}, SartSettings const& settings = quick_settings()) {
  return reconstruct_volume(view_blob(views, nodes, width, radius, centre), make_cube(nodes, width), settings);
}

// A blob is smooth and much larger than a cell (1 mm): the trilinear interpolation of its line integrals errs by
// (h / R)^2 / 4 = 1.6 % at most, which bounds what eight consistent views can recover; three views recover less.
TEST(VolumeReconstruction, BlobIsRecoveredBetterByMoreViews) {
  std::vector<double> const truth = sample_blob(make_cube(nodes, width), radius);
  double const three = compute_relative_error(reconstruct_blob(3).value, truth);
  double const eight = compute_relative_error(reconstruct_blob(8).value, truth);
  EXPECT_LT(eight, 0.032);  // twice the interpolation error, in both projection and comparison
  EXPECT_LT(eight, three);
}

// Line integrals determine the centroid exactly (first moments of the Radon transform). A mirrored or exchanged axis
// would move it by millimetres.
TEST(VolumeReconstruction, BlobIsWhereItIs) {
  Vec3d const centre{2.3e-3, 1.2e-3, -2.6e-3};
  VolumeReconstruction const result = reconstruct_blob(6, centre);
  Vec3d sum{};
  double mass = 0.0;
  std::size_t i = 0;
  visit_cube(result.grid, [&](Vec3d p) {
    sum += result.value[i] * p;
    mass += result.value[i++];
  });
  EXPECT_LT(length(sum / mass - centre), 0.1e-3);  // a tenth of a cell: artefacts at the border of the cube
}

// Every step is homogeneous of degree one, and a factor of two is exact in floating point.
TEST(VolumeReconstruction, TwiceTheLineIntegralsGiveTwiceTheDensity) {
  auto views = view_blob(3, nodes, width, radius);
  RegularGrid const grid = make_cube(nodes, width);
  std::vector<double> once = reconstruct_volume(views, grid, quick_settings()).value;
  for (ProjectedView& view : views)
    for (double& value : view.value) value *= 2.0;
  std::vector<double> const twice = reconstruct_volume(views, grid, quick_settings()).value;
  for (double& value : once) value *= 2.0;
  EXPECT_EQ(once, twice);
}

TEST(VolumeReconstruction, ResultDoesNotDependOnTheNumberOfThreads) {
  set_thread_count(1);
  std::vector<double> const one = reconstruct_blob(3).value;
  set_thread_count(3);
  std::vector<double> const three = reconstruct_blob(3).value;
  set_thread_count(0);
  EXPECT_EQ(one, three);
}

TEST(VolumeReconstruction, BoundsAndSupportHoldAtEveryNode) {
  SartSettings settings = quick_settings();
  settings.lowest = 0.0;
  settings.highest = 0.5;
  std::vector<double> const support = sample_blob(make_cube(nodes, width), radius);
  for (double const value : support) settings.support.push_back(value > 0.1 ? 1 : 0);
  VolumeReconstruction const result = reconstruct_blob(4, {}, settings);
  for (std::size_t i = 0; i < result.value.size(); ++i) {
    EXPECT_GE(result.value[i], 0.0);
    EXPECT_LE(result.value[i], settings.support[i] != 0 ? 0.5 : 0.0);
  }
  EXPECT_GT(*std::max_element(result.value.begin(), result.value.end()), 0.45);
}

TEST(VolumeReconstruction, WithoutDensityDifferenceThereIsNone) {
  auto views = view_blob(3, nodes, width, radius);
  for (ProjectedView& view : views) std::fill(view.value.begin(), view.value.end(), 0.0);
  VolumeReconstruction const result = reconstruct_volume(views, make_cube(nodes, width), quick_settings());
  for (double const value : result.value) EXPECT_EQ(value, 0.0);
  EXPECT_EQ(result.residual.back(), 0.0);
}

// Changes of 3 at each of four nodes have an rms value of 3, and the strength falls by 10 % at most.
TEST(VolumeReconstruction, StrengthOfTheTotalVariationIsTheRmsChange) {
  EXPECT_EQ(choose_tv_strength(36.0, 4, 0.0), 3.0);
  EXPECT_EQ(choose_tv_strength(36.0, 4, 2.0), 3.0);
  EXPECT_EQ(choose_tv_strength(36.0, 4, 10.0), 9.0);
  EXPECT_EQ(choose_tv_strength(0.0, 0, 0.0), 0.0);
}

// Without noise the line integrals agree with the volume better in each sweep, up to the error of the trilinear
// interpolation; noise of 2 % and 4 % of the largest line integral remains, and is projected back in each sweep.
TEST(VolumeReconstruction, StrengthOfTheTotalVariationFollowsTheNoise) {
  SartSettings settings;
  settings.iterations = 40;
  std::vector<double> const truth = sample_blob(make_cube(nodes, width), radius);
  double weight[3], error[3];
  for (int step = 0; step < 3; ++step) {
    auto views = view_blob(6, nodes, width, radius);
    std::mt19937 random(3);
    std::normal_distribution<double> noise(0.0, 0.02 * step * std::sqrt(M_PI) * radius);
    for (ProjectedView& view : views)
      for (double& value : view.value) value += step > 0 ? noise(random) : 0.0;
    VolumeReconstruction const result = reconstruct_volume(views, make_cube(nodes, width), settings);
    weight[step] = result.tv_weight;
    error[step] = compute_relative_error(result.value, truth);
    if (step < 2) continue;
    settings.tv_weight = 0.0;
    double const unsmoothed =
        compute_relative_error(reconstruct_volume(views, make_cube(nodes, width), settings).value, truth);
    EXPECT_LT(error[step], 0.5 * unsmoothed);
  }
  EXPECT_LT(weight[0], 0.5 * weight[1]);  // interpolation error: 1.6 % of the blob, but smooth
  EXPECT_LT(weight[1], weight[2]);
  EXPECT_LT(error[0], error[1]);
  EXPECT_LT(error[1], error[2]);
}

TEST(VolumeReconstruction, EndsWhenTheVolumeNoLongerChanges) {
  SartSettings settings = quick_settings();
  settings.tolerance = 0.05;
  std::size_t const sweeps = reconstruct_blob(6, {}, settings).residual.size();
  EXPECT_LT(sweeps, 30u);
  settings.tolerance = 0.0;
  EXPECT_EQ(reconstruct_blob(6, {}, settings).residual.size(), 30u);
}

TEST(VolumeReconstruction, LinesBesideTheVolumeAreReported) {
  auto const views = view_blob(3, nodes, width, radius, {0.0, 7e-3, 0.0});
  RegularGrid half = make_cube(nodes, width);  // y from -10 to 0 mm: most of the blob is outside
  half.nodes[1] = 11;
  EXPECT_GT(reconstruct_volume(views, half, quick_settings()).outside, 0.5);
}

/// Two off-axis blobs of different size, in parallel views with normal noise relative to the largest integral.
std::vector<ProjectedView> view_two_blobs(int views, double noise) {
  auto all = view_blob(views, nodes, width, radius, {2.5e-3, 1.5e-3, -2e-3});
  auto const second = view_blob(views, nodes, width, 0.6 * radius, {-4e-3, -2e-3, 1e-3});
  std::mt19937 random(11);
  std::normal_distribution<double> normal(0.0, 1.0);
  for (std::size_t v = 0; v < all.size(); ++v)
    for (std::size_t i = 0; i < all[v].value.size(); ++i)
      all[v].value[i] += second[v].value[i] + noise * std::sqrt(M_PI) * radius * normal(random);
  return all;
}

std::vector<std::size_t> contradicting(std::vector<ProjectedView> const& views) {
  std::vector<std::size_t> found;
  SartSettings settings;
  settings.iterations = 15;
  VolumeReconstruction const result = reconstruct_volume(views, make_cube(nodes, width), settings);
  for (ContradictingView const& one : find_contradicting_views(result.view_residual)) found.push_back(one.view);
  return found;
}

// The sum of the line integrals in each plane across the axis is the mass in it, the same in every view: a view with
// another sign, scale or position along the axis contradicts the others even if there are only two of them.
TEST(VolumeReconstruction, OneViewThatContradictsTheOthersIsFound) {
  for (int const count : {3, 4, 8}) {
    SCOPED_TRACE(count);
    for (double const noise : {0.0, 0.05}) EXPECT_THAT(contradicting(view_two_blobs(count, noise)), IsEmpty());
    auto views = view_two_blobs(count, 0.01);
    for (double& value : views[1].value) value = -value;
    if (count == 3)  // of three views, two may be named
      EXPECT_THAT(contradicting(views), AllOf(Contains(1), Not(Contains(2))));
    else
      EXPECT_THAT(contradicting(views), ElementsAre(1));
    views = view_two_blobs(count, 0.01);
    for (double& value : views[2].value) value *= 1.5;
    EXPECT_THAT(contradicting(views), ElementsAre(2));
    views = view_two_blobs(count, 0.01);
    std::rotate(views[0].value.begin(), views[0].value.begin() + 4 * nodes, views[0].value.end());  // by 4 mm along Y
    EXPECT_THAT(contradicting(views), ElementsAre(0));
  }
}

// The centroid moves like a sinusoid of the angle, which has two amplitudes: eight views determine them several times.
TEST(VolumeReconstruction, OneOfManyViewsShiftedAcrossTheAxisIsFound) {
  for (int const count : {8, 16}) {
    auto views = view_two_blobs(count, 0.01);
    std::rotate(views[3].value.begin(), views[3].value.begin() + 3, views[3].value.end());
    EXPECT_THAT(contradicting(views), ElementsAre(3)) << count;
  }
}

TEST(VolumeReconstruction, UnusableViewsAreRefused) {
  RegularGrid const grid = make_cube(nodes, width);
  auto const views = view_blob(3, nodes, width, radius);
  EXPECT_THAT(
      [&] {
        reconstruct_volume({views[0], views[1]}, grid, quick_settings());
      },
      ThrowsDataError(ErrorCode::undetermined, "tomography"));

  auto different = views;
  different[1].value.pop_back();
  EXPECT_THAT([&] { reconstruct_volume(different, grid, quick_settings()); },
              ThrowsDataError(ErrorCode::wrong_shape, different[1].name));

  auto unmeasured = views;
  std::fill(unmeasured[2].value.begin(), unmeasured[2].value.end(), not_a_number);
  EXPECT_THAT([&] { reconstruct_volume(unmeasured, grid, quick_settings()); },
              ThrowsDataError(ErrorCode::no_valid_vector, unmeasured[2].name));

  auto apart = views;  // the third camera looks past the volume
  for (SightLine& line : apart[2].lines) line.origin.y += 1.0;
  EXPECT_THAT([&] { reconstruct_volume(apart, grid, quick_settings()); },
              ThrowsDataError(ErrorCode::undetermined, "tomography"));
}

TEST(VolumeReconstruction, SettingsOutOfRangeAreReportedTogether) {
  SartSettings settings;
  settings.iterations = 0;
  settings.relaxation = 2.0;
  settings.tv_weight = -1.0;
  settings.lowest = 0.1;
  try {
    reconstruct_blob(3, {}, settings);
    FAIL();
  } catch (SetupError const& error) {
    EXPECT_EQ(error.problems().size(), 4u);
  }
}

}  // namespace
}  // namespace gladstone::inline tomography
