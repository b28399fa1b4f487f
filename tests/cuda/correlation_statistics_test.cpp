#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <functional>
#include <limits>

#include "analysis/correlation/correlator.h"
#include "analysis/uncertainty/uncertainty.h"
#include "cuda/backend.h"
#include "studies/benchmark/particle_pair.h"
#include "tests/cuda/memory_limits.h"

namespace gladstone::cuda {
namespace {

class CudaSigma : public ::testing::Test {
 protected:
  void SetUp() override {
    if (DeviceState const state = device_state(); !state.usable) GTEST_SKIP() << state.text;
  }
};

CorrelationSettings with_statistics(std::vector<int> windows = CorrelationSettings().window_px) {
  CorrelationSettings settings;
  settings.window_px = std::move(windows);
  settings.uncertainty = "correlation_statistics";
  return settings;
}

ParticlePair moved_dots(std::function<Vec2d(Vec2d)> const& displacement, double noise, int columns = 300,
                        int rows = 260) {
  return render_particle_pair({.columns = columns, .rows = rows, .noise = noise, .seed = 5}, displacement);
}

Vec2d shear(Vec2d p) { return {0.4 + 0.01 * p.y, -0.3}; }

/// Compares two estimates of the standard uncertainty of a vector. The device deforms the frames by the same spline in
/// another order of operations: coefficients are sums of about forty products in float, which causes errors of up to
/// 2e-6 of the contrast in a pixel. Frames of 8 bits differ by at least 1.6e-3 of the contrast (1/255/sqrt(12) in
/// each), and sigma is the square root of a sum of products of that difference. If all pixels had the same error, sigma
/// would change by 2e-6/1.6e-3 of the sum of the products' magnitudes. With noise, that sum corresponds to sigma
/// itself; without noise, the products may cancel, and the sum corresponds at least to 8 bits, 1e-3 px (noise of 5 %
/// results in 0.04 px, so 0.11 % results in that).
/// @param of_vector_px  difference of the vectors: sigma changes by at most the difference of the vector that deforms
///   its
///   frames
void expect_near(Vec2d sigma, Vec2d expected, double of_vector_px, std::size_t i) {
  for (double Vec2d::*axis : {&Vec2d::x, &Vec2d::y}) {
    double const found = sigma.*axis, right = expected.*axis;
    ASSERT_EQ(std::isnan(found), std::isnan(right)) << i;
    if (std::isnan(right)) continue;
    double const without_signs = std::hypot(right, 1e-3);
    EXPECT_NEAR(found * found, right * right, 2.0 * without_signs * (1.3e-3 * without_signs + of_vector_px)) << i;
  }
}

bool alike_around(DisplacementField const& a, DisplacementField const& b, std::size_t i) {
  int const column = static_cast<int>(i) % a.columns, row = static_cast<int>(i) / a.columns;
  for (int y = std::max(0, row - 1); y <= std::min(a.rows - 1, row + 1); ++y)
    for (int x = std::max(0, column - 1); x <= std::min(a.columns - 1, column + 1); ++x) {
      std::size_t const k = static_cast<std::size_t>(y) * a.columns + x;
      if (a.status[k] != b.status[k]) return false;
    }
  return true;
}

/// Compares the uncertainties of the device with those that the CPU estimates for the same vectors, and for its own
/// vectors, which differ by up to 1e-4 px.
/// @return number of vectors with an uncertainty
std::size_t expect_sigma_of_the_cpu(CorrelationSettings const& settings, ParticlePair const& pair) {
  HostFrames const frames(pair.reference, pair.flow);
  DisplacementField const field = cuda::make_correlator(settings)->correlate_pair(frames);
  EXPECT_EQ(field.sigma_px.size(), field.size());
  DisplacementField same = field, own = gladstone::make_correlator(settings)->correlate_pair(frames);
  estimate_uncertainty(same, frames, settings);
  estimate_uncertainty(own, frames, settings);
  std::size_t known = 0, others = 0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    expect_near(field.sigma_px[i], same.sigma_px[i], 0.0, i);
    known += std::isfinite(field.sigma_px[i].x) && std::isfinite(field.sigma_px[i].y);
    if (alike_around(field, own, i))
      expect_near(field.sigma_px[i], own.sigma_px[i], 1e-4, i);
    else
      ++others;
  }
  EXPECT_LE(static_cast<double>(others), 0.01 * static_cast<double>(field.size()));
  return known;
}

// All of these vectors have an uncertainty, including those whose windows are cut by the border.
TEST_F(CudaSigma, OfUniformDisplacementAndShearIsThatOfTheCpu) {
  for (double const noise : {0.0, 0.05}) {
    CorrelationSettings const settings = with_statistics();
    InterrogationGrid const grid = final_grid(settings, 300, 260);
    EXPECT_EQ(expect_sigma_of_the_cpu(settings, moved_dots(
                                                    [](Vec2d) {
                                                      return Vec2d{0.3, -0.7};
                                                    },
                                                    noise)),
              grid.size());
    EXPECT_EQ(expect_sigma_of_the_cpu(settings, moved_dots(shear, noise)), grid.size());
  }
}

TEST_F(CudaSigma, OfOtherPassesIsThatOfTheCpu) {
  ParticlePair const pair = moved_dots(shear, 0.03);
  for (char const* weighting : {"gaussian", "uniform"})
    for (char const* deformation : {"quintic", "cubic"}) {
      CorrelationSettings settings = with_statistics({32, 22});
      settings.weighting = weighting;
      settings.deformation = deformation;
      settings.final_passes = 2;
      EXPECT_GT(expect_sigma_of_the_cpu(settings, pair), 500u) << weighting;
    }
  CorrelationSettings settings = with_statistics({24});
  settings.method = "rpc";
  settings.subpixel = "gauss2d";
  EXPECT_GT(expect_sigma_of_the_cpu(settings, pair), 500u);
}

TEST_F(CudaSigma, OfFramesOfOtherBrightnessIsThatOfTheCpu) {
  ParticlePair pair = moved_dots(shear, 0.03);
  for (double& level : pair.flow) level = 0.5 * level + 20.0;
  EXPECT_GT(expect_sigma_of_the_cpu(with_statistics(), pair), 500u);
}

// A single pass, whose frames are deformed for the uncertainty only; windows with fewer pixels than the threads of a
// warp, and with more than those of a block.
TEST_F(CudaSigma, OfSmallAndLargeWindowsIsThatOfTheCpu) {
  EXPECT_GT(expect_sigma_of_the_cpu(with_statistics({8}), moved_dots(shear, 0.02)), 500u);
  EXPECT_GT(expect_sigma_of_the_cpu(with_statistics({160}), moved_dots(shear, 0.02)), 0u);
}

// Windows that are partly or completely masked, and windows without a dot, which contain no signal.
TEST_F(CudaSigma, OfMaskedAndDotFreeWindowsIsThatOfTheCpu) {
  ParticlePair pair = moved_dots(shear, 0.02);
  for (int j = 0; j < 70; ++j)
    for (int i = 100; i < 190; ++i)
      (j % 2 == 0 ? pair.reference : pair.flow)(i, j) = std::numeric_limits<double>::quiet_NaN();
  pair.reference(250, 200) = std::numeric_limits<double>::infinity();
  for (int j = 150; j < 220; ++j)
    for (int i = 0; i < 70; ++i) pair.reference(i, j) = pair.flow(i, j) = 17.0;
  for (CorrelationSettings const& settings : {with_statistics(), with_statistics({16})}) {
    std::size_t const known = expect_sigma_of_the_cpu(settings, pair), all = final_grid(settings, 300, 260).size();
    EXPECT_GT(known, all / 2);
    EXPECT_LT(known, all - 10);
  }
}

TEST_F(CudaSigma, IsNotKnownWhereNothingIs) {
  Image<double> const even(128, 128, 40.0);
  DisplacementField const field = cuda::make_correlator(with_statistics())->correlate(even, even);
  ASSERT_EQ(field.sigma_px.size(), field.size());
  for (Vec2d const& sigma : field.sigma_px) EXPECT_TRUE(std::isnan(sigma.x) && std::isnan(sigma.y));
}

// The vectors are the same with and without uncertainties, and in every run.
TEST_F(CudaSigma, LeavesTheVectorsAndIsTheSameEveryTime) {
  ParticlePair const pair = moved_dots(shear, 0.3), other = moved_dots(shear, 0.1);
  auto const correlator = cuda::make_correlator(with_statistics());
  DisplacementField const first = correlator->correlate(pair.reference, pair.flow);
  DisplacementField const without = cuda::make_correlator({})->correlate(pair.reference, pair.flow);
  EXPECT_TRUE(without.sigma_px.empty());
  auto const same = [](auto const& a, auto const& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
  };
  EXPECT_TRUE(same(first.displacement_px, without.displacement_px));
  EXPECT_TRUE(same(first.status, without.status));
  correlator->correlate(other.reference, other.flow);  // leaves other data in the retained memory
  DisplacementField const again = correlator->correlate(pair.reference, pair.flow);
  for (std::size_t i = 0; i < first.size(); ++i)
    for (double Vec2d::*axis : {&Vec2d::x, &Vec2d::y}) {
      double const one = first.sigma_px[i].*axis, other_one = again.sigma_px[i].*axis;
      EXPECT_TRUE(one == other_one || (std::isnan(one) && std::isnan(other_one))) << i;
    }
}

// If a window does not fit into shared memory, a block processes its windows in device memory, one after the other. The
// two kernels sum in the same order, but may fuse different products: the variances differ by 4e-6 of the sum of the
// products' magnitudes, which is at most twenty times the variance.
TEST_F(CudaSigma, IsTheSameWithLittleSharedMemory) {
  ParticlePair const pair = moved_dots(shear, 0.03, 400, 400);
  CorrelationSettings settings = with_statistics({64, 32});
  settings.overlap = 0.75;
  DisplacementField const expected = cuda::make_correlator(settings)->correlate(pair.reference, pair.flow);
  SharedMemoryLimit const limit(8000);
  DisplacementField const field = cuda::make_correlator(settings)->correlate(pair.reference, pair.flow);
  ASSERT_GT(field.size(), 264u) << "more windows than are processed at a time";
  for (std::size_t i = 0; i < field.size(); ++i) {
    ASSERT_TRUE(std::isfinite(expected.sigma_px[i].x) && std::isfinite(expected.sigma_px[i].y));
    EXPECT_NEAR(field.sigma_px[i].x / expected.sigma_px[i].x, 1.0, 4e-5) << i;
    EXPECT_NEAR(field.sigma_px[i].y / expected.sigma_px[i].y, 1.0, 4e-5) << i;
  }
}

// For other methods, the CPU estimates the uncertainties of the device's vectors.
TEST_F(CudaSigma, OfAnotherMethodIsLeftToTheCpu) {
  ParticlePair const pair = moved_dots(shear, 0.03);
  CorrelationSettings settings;
  settings.uncertainty = "image_matching";
  EXPECT_TRUE(cuda::make_correlator(settings)->correlate(pair.reference, pair.flow).sigma_px.empty());
}

}  // namespace
}  // namespace gladstone::cuda
