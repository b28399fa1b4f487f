#include "analysis/correlation/correlator.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <thread>
#include <vector>

#include "cuda/backend.h"
#include "render/base/error.h"
#include "studies/benchmark/particle_pair.h"

namespace gladstone::cuda {
namespace {

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

class CudaCorrelation : public ::testing::Test {
 protected:
  void SetUp() override {
    if (DeviceState const state = device_state(); !state.usable) GTEST_SKIP() << state.text;
  }
};

ParticlePair smooth_pair(int columns, int rows, double noise = 0.0, std::uint64_t seed = 1,
                         double particles_per_px = 20.0 / 1024.0) {
  ParticleSettings particles;
  particles.particles_per_px = particles_per_px;
  particles.columns = columns;
  particles.rows = rows;
  particles.noise = noise;
  particles.seed = seed;
  return render_particle_pair(particles, [](Vec2d p) {
    return Vec2d{1.7 + std::sin(0.03 * p.y), 0.8 * std::cos(0.032 * p.x)};
  });
}

CorrelationSettings with_windows(std::vector<int> windows) {
  CorrelationSettings settings;
  settings.window_px = std::move(windows);
  return settings;
}

/// Returns the vectors measured on the CPU by the reference method for scc: complete transforms in double precision.
DisplacementField reference_vectors(CorrelationSettings settings, ParticlePair const& pair) {
  if (settings.method == "scc") settings.method = "opencv";
  return gladstone::make_correlator(settings)->correlate(pair.reference, pair.flow);
}

/// Compares the device with the CPU: both use the same arithmetic in another order, and the device's transforms in
/// float (relative errors of 6e-8, some tens of times), so that peaks agree to 1e-4 px. A status may only differ if a
/// residual is that close to its limit or two peaks are that close to each other.
void expect_same(CorrelationSettings const& settings, ParticlePair const& pair) {
  DisplacementField const expected = reference_vectors(settings, pair);
  DisplacementField const field = cuda::make_correlator(settings)->correlate(pair.reference, pair.flow);
  ASSERT_EQ(field.size(), expected.size());
  EXPECT_EQ(field.columns, expected.columns);
  std::size_t differing = 0;
  for (std::size_t i = 0; i < field.size(); ++i) {
    EXPECT_EQ(field.position_px[i], expected.position_px[i]);
    if (field.status[i] != expected.status[i] || field.reason[i] != expected.reason[i] ||
        field.failed[i] != expected.failed[i]) {
      ++differing;
      continue;
    }
    ASSERT_EQ(std::isnan(field.peak_ratio[i]), std::isnan(expected.peak_ratio[i])) << i;
    if (!expected.counts(i)) {
      EXPECT_TRUE(std::isnan(field.displacement_px[i].x)) << i;
      continue;
    }
    EXPECT_LT(length(field.displacement_px[i] - expected.displacement_px[i]), 1e-4)
        << i << " at " << expected.position_px[i].x << ", " << expected.position_px[i].y;
  }
  EXPECT_LE(static_cast<double>(differing), 1e-4 * static_cast<double>(field.size()));
}

TEST_F(CudaCorrelation, OfTheDefaultPassesIsThatOfTheCpu) { expect_same({}, smooth_pair(512, 512)); }

TEST_F(CudaCorrelation, OfNoisyImagesIsThatOfTheCpu) { expect_same({}, smooth_pair(500, 390, 0.1)); }

// Noise that makes vectors fail each of the tests; they are first replaced, then not.
TEST_F(CudaCorrelation, OfVectorsThatFailTestsIsThatOfTheCpu) {
  CorrelationSettings settings;
  settings.least_peak_ratio = 1.3;
  settings.least_correlation = 0.3;
  for (bool const replace : {true, false}) {
    settings.replace = replace;
    expect_same(settings, smooth_pair(500, 390, 0.25));
  }
}

// Displacements of 0.7 to 2.7 px along x: some vectors exceed the limit, and so do some replacements.
TEST_F(CudaCorrelation, WithinALimitIsThatOfTheCpu) {
  CorrelationSettings settings;
  settings.max_displacement_px = 1.8;
  expect_same(settings, smooth_pair(512, 512));
  settings.window_px = {32};
  expect_same(settings, smooth_pair(512, 512, 0.05));
}

TEST_F(CudaCorrelation, WithUniformWindowsAndCubicSplinesIsThatOfTheCpu) {
  CorrelationSettings settings;
  settings.weighting = "uniform";
  settings.deformation = "cubic";
  settings.final_passes = 2;
  expect_same(settings, smooth_pair(300, 260));
}

// Supports of 32 and 64 px have specialised kernels; those of 40, 48, 96 and 128 px are transformed by factors, others
// up to about 160 px line by line in shared memory, larger ones in device memory. 22, 46 and 94 px contain the primes
// 11, 23 and 47. Windows of 8 px need a higher particle density to contain any signal.
class CudaWindowSize : public CudaCorrelation, public ::testing::WithParamInterface<int> {};
TEST_P(CudaWindowSize, GivesTheVectorsOfTheCpu) {
  int const window = GetParam();
  expect_same(with_windows({window}), window < 16 ? smooth_pair(300, 260, 0.0, 1, 0.1) : smooth_pair(300, 260));
}
INSTANTIATE_TEST_SUITE_P(Px, CudaWindowSize, ::testing::Values(8, 10, 16, 20, 22, 24, 32, 46, 48, 64, 80, 94),
                         ::testing::PrintToStringParamName());

TEST_F(CudaCorrelation, ByNinePointsIsThatOfTheCpu) {
  CorrelationSettings settings;
  settings.subpixel = "gauss2d";
  expect_same(settings, smooth_pair(512, 512, 0.05));
}

// The phases of wave numbers without signal are random; noise, as in real images, fills them.
TEST_F(CudaCorrelation, ByPhasesIsThatOfTheCpu) {
  CorrelationSettings settings;
  settings.method = "rpc";
  for (char const* weighting : {"gaussian", "uniform"})
    for (std::vector<int> const& windows :
         {std::vector<int>{64, 32, 24, 20}, std::vector<int>{48, 20}, std::vector<int>{22}}) {
      settings.weighting = weighting;
      settings.window_px = windows;
      expect_same(settings, smooth_pair(400, 300, 0.02));
    }
}

TEST_F(CudaCorrelation, OfUniformWindowsIsThatOfTheCpu) {
  for (int const window : {16, 20, 24, 32, 48, 64}) {
    CorrelationSettings settings = with_windows({window});
    settings.weighting = "uniform";
    expect_same(settings, smooth_pair(400, 300, 0.02));
  }
}

// A twentieth of the vectors is wrong by several pixels or has no agreeing neighbours, which covers every branch of the
// validation.
TEST_F(CudaCorrelation, ReplacesSpuriousVectorsAsTheCpuDoes) {
  ParticlePair const pair = smooth_pair(400, 300, 0.3);
  CorrelationSettings const settings = with_windows({16});
  DisplacementField const expected = gladstone::make_correlator(settings)->correlate(pair.reference, pair.flow);
  auto const replaced = std::count(expected.status.begin(), expected.status.end(), VectorStatus::replaced);
  EXPECT_GT(replaced, static_cast<std::ptrdiff_t>(expected.size() / 20));
  expect_same(settings, pair);
}

TEST_F(CudaCorrelation, OfDenselyOverlappingWindowsIsThatOfTheCpu) {
  CorrelationSettings settings = with_windows({32});
  settings.overlap = 0.9;
  expect_same(settings, smooth_pair(301, 259, 0.05));
}

// Pixels that are unknown in one of the images, and an area without signal.
TEST_F(CudaCorrelation, LeavesOutUnknownPixelsAsTheCpuDoes) {
  ParticlePair pair = smooth_pair(300, 260);
  for (int j = 0; j < 70; ++j)
    for (int i = 100; i < 190; ++i) (j % 2 == 0 ? pair.reference : pair.flow)(i, j) = nan;
  pair.reference(250, 200) = std::numeric_limits<double>::infinity();
  expect_same({}, pair);
  for (int j = 150; j < 200; ++j)
    for (int i = 0; i < 60; ++i) pair.reference(i, j) = pair.flow(i, j) = 17.0;
  expect_same(with_windows({16}), pair);
}

// An image without signal has no contrast: every vector is invalid, in every pass.
TEST_F(CudaCorrelation, FindsNothingInAnEvenImage) {
  Image<double> const even(128, 128, 40.0);
  for (VectorStatus const status : cuda::make_correlator({})->correlate(even, even).status)
    EXPECT_EQ(status, VectorStatus::invalid);
  Image<double> const unknown(128, 128, nan);
  for (VectorStatus const status : cuda::make_correlator({})->correlate(unknown, even).status)
    EXPECT_EQ(status, VectorStatus::masked);
}

// The measured displacement does not depend on the unit of the grey levels.
TEST_F(CudaCorrelation, DoesNotDependOnTheUnitOfGrey) {
  ParticlePair pair = smooth_pair(128, 128);
  auto const correlator = cuda::make_correlator(with_windows({32, 16}));
  DisplacementField const expected = correlator->correlate(pair.reference, pair.flow);
  for (double const unit : {0x1p-80, 0x1p90}) {
    ParticlePair scaled = pair;
    for (Image<double>* image : {&scaled.reference, &scaled.flow})
      for (double& value : *image) value *= unit;
    DisplacementField const field = correlator->correlate(scaled.reference, scaled.flow);
    for (std::size_t i = 0; i < field.size(); ++i) EXPECT_EQ(field.displacement_px[i], expected.displacement_px[i]);
  }
}

TEST_F(CudaCorrelation, GivesTheSameBitsEveryTime) {
  ParticlePair const pair = smooth_pair(400, 400, 0.3), other = smooth_pair(400, 400, 0.3, 7);
  auto const correlator = cuda::make_correlator({});
  auto const same = [](auto const& a, auto const& b) {
    return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0;
  };
  DisplacementField const first = correlator->correlate(pair.reference, pair.flow);
  correlator->correlate(other.reference, other.flow);  // leaves other data in the retained memory
  for (DisplacementField const& again : {correlator->correlate(pair.reference, pair.flow),
                                         cuda::make_correlator({})->correlate(pair.reference, pair.flow)}) {
    EXPECT_TRUE(same(first.displacement_px, again.displacement_px));
    EXPECT_TRUE(same(first.peak_ratio, again.peak_ratio));
    EXPECT_TRUE(same(first.status, again.status));
  }
}

// Sequences share one correlator between threads, more than it has buffers for.
TEST_F(CudaCorrelation, OfSeveralThreadsIsThatOfOne) {
  constexpr std::size_t count = 12;
  auto const correlator = cuda::make_correlator({});
  std::vector<ParticlePair> pairs;
  std::vector<DisplacementField> expected, fields(count);
  for (std::size_t k = 0; k < count; ++k) {
    pairs.push_back(smooth_pair(256, 256, 0.1, k + 1));
    expected.push_back(correlator->correlate(pairs[k].reference, pairs[k].flow));
  }
  std::vector<std::thread> threads;
  for (std::size_t k = 0; k < count; ++k)
    threads.emplace_back([&, k] { fields[k] = correlator->correlate(pairs[k].reference, pairs[k].flow); });
  for (std::thread& thread : threads) thread.join();
  for (std::size_t k = 0; k < count; ++k) {
    ASSERT_EQ(fields[k].size(), expected[k].size()) << k;
    EXPECT_EQ(std::memcmp(fields[k].displacement_px.data(), expected[k].displacement_px.data(),
                          expected[k].size() * sizeof(Vec2d)),
              0)
        << k;
  }
}

TEST_F(CudaCorrelation, TakesPairsOfAnySizeOneAfterTheOther) {
  CorrelationSettings settings = with_windows({16});
  settings.overlap = 0.5;
  auto const correlator = cuda::make_correlator(settings);
  for (int const size : {100, 64, 131}) {
    ParticlePair const pair = smooth_pair(size, 90);
    DisplacementField const field = correlator->correlate(pair.reference, pair.flow);
    EXPECT_EQ(field.columns, (size - 16) / 8 + 1);
  }
}

TEST_F(CudaCorrelation, RefusesWhatTheCpuRefuses) {
  auto const correlator = cuda::make_correlator({});
  EXPECT_THROW(correlator->correlate(Image<double>(100, 100), Image<double>(100, 101)), DataError);
  EXPECT_THROW(correlator->correlate(Image<double>(50, 100), Image<double>(50, 100)), DataError);
}

}  // namespace
}  // namespace gladstone::cuda
