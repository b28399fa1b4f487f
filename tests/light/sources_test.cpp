#include "render/light/sources.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace gladstone {
namespace {

constexpr double two_pow_32 = 4294967296.0;

constexpr BundleView one_scrambling{.seed = 11};

// The first eight points of Joe and Kuo's sequence (new-joe-kuo-6), which is listed in Gray-code order k ^ (k >> 1).
TEST(Sobol, FirstPointsAreJoeAndKuos) {
  double const points[8][4] = {{0, 0, 0, 0},
                               {0.5, 0.5, 0.5, 0.5},
                               {0.75, 0.25, 0.25, 0.25},
                               {0.25, 0.75, 0.75, 0.75},
                               {0.375, 0.375, 0.625, 0.875},
                               {0.875, 0.875, 0.125, 0.375},
                               {0.625, 0.125, 0.875, 0.625},
                               {0.125, 0.625, 0.375, 0.125}};
  for (std::uint32_t k = 0; k < 8; ++k) {
    for (int dimension = 0; dimension < 4; ++dimension) {
      EXPECT_EQ(sobol_bits(k ^ (k >> 1), dimension) / two_pow_32, points[k][dimension]) << k << " " << dimension;
    }
  }
}

// Coordinates are correct for any bit pattern of the index: full and empty bytes, and single bits.
TEST(Sobol, PointHasItsCoordinates) {
  std::vector<std::uint32_t> indices{0u, 255u, 256u, 65535u, 65536u, 0xff00ff00u, 0x12345678u, 0xffffffffu};
  for (std::uint32_t k = 0; k < 32; ++k) indices.push_back(1u << k);
  for (std::uint32_t const index : indices) {
    std::uint32_t point[4];
    sobol_point(index, point);
    for (int dimension = 0; dimension < 4; ++dimension) EXPECT_EQ(point[dimension], sobol_bits(index, dimension));
  }
}

/// Returns the smallest and the largest number of points in the elementary intervals of volume 2^-bits of a pair of
/// dimensions.
std::pair<int, int> extremes_of_elementary_intervals(int first, int second, int points_log2, int bits,
                                                     std::uint32_t const (&seeds)[2]) {
  int fewest = 1 << points_log2, most = 0;
  for (int along_first = 0; along_first <= bits; ++along_first) {
    std::vector<int> counts(std::size_t{1} << bits, 0);
    for (std::uint32_t i = 0; i < (1u << points_log2); ++i) {
      std::uint64_t a = sobol_bits(i, first), b = sobol_bits(i, second);
      if (seeds[0] != 0) {
        a = owen_scramble(static_cast<std::uint32_t>(a), seeds[0]);
        b = owen_scramble(static_cast<std::uint32_t>(b), seeds[1]);
      }
      std::uint64_t const cell_a = a >> (32 - along_first), cell_b = b >> (32 - (bits - along_first));
      ++counts[static_cast<std::size_t>((cell_a << (bits - along_first)) | cell_b)];
    }
    fewest = std::min(fewest, *std::min_element(counts.begin(), counts.end()));
    most = std::max(most, *std::max_element(counts.begin(), counts.end()));
  }
  return {fewest, most};
}

// A (0,m,2)-net has exactly one of its 2^m points in every elementary interval of volume 2^-m (Niederreiter 1987). The
// first two Sobol dimensions are such a net; dimensions with polynomials of degrees 2 and 3 are a (t,m,2)-net with t =
// 1 + 2.
TEST(Sobol, PupilPairIsANetWithOnePointPerElementaryInterval) {
  EXPECT_EQ(extremes_of_elementary_intervals(0, 1, 8, 8, {0, 0}), (std::pair{1, 1}));
}
TEST(Sobol, SourcePairIsANetOfQualityThree) {
  EXPECT_EQ(extremes_of_elementary_intervals(2, 3, 11, 8, {0, 0}), (std::pair{8, 8}));
}

// Nested scrambling permutes elementary intervals among themselves.
TEST(OwenScrambling, KeepsTheNets) {
  for (std::uint32_t seed = 1; seed < 40; ++seed) {
    std::uint32_t const seeds[2] = {seed * 2654435761u, seed * 40503u + 17u};
    EXPECT_EQ(extremes_of_elementary_intervals(0, 1, 8, 8, seeds), (std::pair{1, 1})) << seed;
    EXPECT_EQ(extremes_of_elementary_intervals(2, 3, 11, 8, seeds), (std::pair{8, 8})) << seed;
  }
}

// Rays are assigned to the scramblings in turn: ray 4 k + i is point k of scrambling i of four. The first scrambling is
// the one that is used alone if there is only one. Sixteen points of each scrambling fill the sixteen intervals of
// every coordinate. Different scramblings are independent: over 2000 sources, the correlation of their points is zero
// within five standard errors.
TEST(Sobol, RaysAreDealtToIndependentScramblings) {
  BundleView dealt = one_scrambling;
  dealt.scrambling_bits = 2;
  double u[sobol_dimensions], v[sobol_dimensions];
  for (std::uint64_t scrambling = 0; scrambling < 4; ++scrambling) {
    int filled[sobol_dimensions] = {};
    for (std::uint64_t point = 0; point < 16; ++point) {
      sample_coordinates(dealt, 5, 4 * point + scrambling, u);
      sample_coordinates(one_scrambling, 5, point, v);
      for (int dimension = 0; dimension < sobol_dimensions; ++dimension) {
        filled[dimension] |= 1 << static_cast<int>(16 * u[dimension]);
        EXPECT_EQ(u[dimension] == v[dimension], scrambling == 0);
      }
    }
    for (int const intervals : filled) EXPECT_EQ(intervals, 0xffff);
  }
  constexpr int sources = 2000;
  double sum[sobol_dimensions] = {};
  for (std::uint64_t source = 0; source < sources; ++source) {
    sample_coordinates(dealt, source, 0, u);
    sample_coordinates(dealt, source, 1, v);
    for (int dimension = 0; dimension < sobol_dimensions; ++dimension) {
      sum[dimension] += 12 * (u[dimension] - 0.5) * (v[dimension] - 0.5);
    }
  }
  for (double const correlation : sum) EXPECT_NEAR(correlation / sources, 0, 5 / std::sqrt(double(sources)));
}

TEST(Sobol, AHandfulOfRaysHasFewerScramblings) {
  for (auto const& [rays, bits] :
       {std::pair{1, 0}, {2, 1}, {3, 1}, {4, 2}, {7, 2}, {8, 3}, {511, 3}, {512, 2}, {65536, 2}}) {
    EXPECT_EQ(scrambling_bits(static_cast<std::uint64_t>(rays)), bits) << rays;
    EXPECT_LE(1 << bits, most_scramblings);
  }
}

// Over the scramblings of many sources, every point is uniformly distributed, with mean 1/2 and variance 1/12 within
// five standard errors, sqrt(1/(12 n)) and sqrt((1/80 - 1/144)/n). Coordinates of different dimensions, of neighbouring
// sources, and bits of different streams are uncorrelated within 5/sqrt(n).
TEST(OwenScrambling, IsUnbiasedAndIndependentFromSourceToSource) {
  constexpr int n = 8192;
  for (std::uint64_t const ray : {0ull, 5ull, 1000ull}) {
    std::vector<double> value[4];
    for (std::uint64_t source = 0; source < n; ++source) {
      double u[sobol_dimensions];
      sample_coordinates(one_scrambling, source, ray, u);
      for (int d = 0; d < 4; ++d) value[d].push_back(u[d]);
    }
    for (int d = 0; d < 4; ++d) {
      double mean = 0, variance = 0, neighbours = 0, dimensions = 0;
      for (std::size_t i = 0; i < n; ++i) {
        mean += value[d][i] / n;
        variance += (value[d][i] - 0.5) * (value[d][i] - 0.5) / n;
        neighbours += 12 * (value[d][i] - 0.5) * (value[d][(i + 1) % n] - 0.5) / n;
        dimensions += 12 * (value[d][i] - 0.5) * (value[(d + 1) % 4][i] - 0.5) / n;
      }
      EXPECT_NEAR(mean, 0.5, 5 * std::sqrt(1.0 / 12 / n));
      EXPECT_NEAR(variance, 1.0 / 12, 5 * std::sqrt((1.0 / 80 - 1.0 / 144) / n));
      EXPECT_NEAR(neighbours, 0, 5 / std::sqrt(n));
      EXPECT_NEAR(dimensions, 0, 5 / std::sqrt(n));
    }
  }
}

TEST(RandomStreams, OfOneSeedAreIndependent) {
  constexpr int n = 8192;
  RandomStream const streams[] = {RandomStream::target, RandomStream::pupil, RandomStream::noise_reference,
                                  RandomStream::noise_flow};
  for (int a = 0; a < 4; ++a) {
    for (int b = a + 1; b < 4; ++b) {
      double correlation = 0;
      for (std::uint64_t i = 0; i < n; ++i) {
        correlation +=
            12 * (to_unit(random_bits(7, streams[a], i)) - 0.5) * (to_unit(random_bits(7, streams[b], i)) - 0.5) / n;
      }
      EXPECT_NEAR(correlation, 0, 5 / std::sqrt(n)) << a << " " << b;
    }
  }
}

// A position beyond the range of integer nanometres also has a key, one for each side; all other positions have
// different keys if they differ by a nanometre.
TEST(SourceKey, EveryFinitePlaceHasAKey) {
  EXPECT_EQ(random_key({1e300, 0}), random_key({1e10, 0}));
  EXPECT_EQ(random_key({0, -1e300}), random_key({0, -1e10}));
  EXPECT_NE(random_key({1e300, 0}), random_key({-1e300, 0}));
  EXPECT_NE(random_key({1e300, 0}), random_key({0, 1e300}));
  EXPECT_NE(random_key({1e-9, 0}), random_key({2e-9, 0}));
  EXPECT_NE(random_key({1e9, 0}), random_key({1e9 + 1e-6, 0}));
}

}  // namespace
}  // namespace gladstone
