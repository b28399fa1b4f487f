#include "render/sensor/pixel_noise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/sensor/detector.h"

namespace gladstone {
namespace {

double normal_probability(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

// The uniform number is computed without a conversion of integers: (first 52 bits + 1/2) / 2^52, exactly.
TEST(FrameNoise, IsUniformBetweenZeroAndOne) {
  for (std::uint64_t const bits : {0ull, 0xfffull, 0x1000ull, 0x123456789abcdef0ull, ~0ull}) {
    EXPECT_EQ(to_open_unit(bits), (static_cast<double>(bits >> 12) + 0.5) * 0x1p-52) << bits;
  }
  FrameNoise const noise(7, RandomStream::noise_flow);
  EXPECT_EQ(noise.read(41), mix64(noise.state(41) + FrameNoise::increment));
  EXPECT_EQ(noise.shot(42), mix64(noise.state(41) + 2 * FrameNoise::increment));
}

// The mantissa's part has a relative error of 4e-9; it is at most ln(2) / 2, and the other part is exact.
TEST(FastLogarithm, HasItsStatedError) {
  for (double t = 1; t > 1e-16; t *= 0.993) {
    EXPECT_NEAR(fast_logarithm(t), std::log(t), 4.1e-9 * std::min(0.35, std::abs(std::log(t))) + 1e-15) << t;
  }
}

// The quantile is the inverse of the distribution. Its relative error of 1.2e-7 changes z by up to 1e-6 at 8 standard
// deviations, and hence a probability p by z p 1e-6 at most. The central part ends at u = 0.00048.
TEST(NormalQuantile, IsTheInverseOfTheDistribution) {
  for (double const u : {1e-15, 1e-11, 3e-6, 0.00048, 0.00049, 0.001, 0.075, 0.2, 0.5, 0.7, 0.925, 0.9999}) {
    double const z = NormalQuantile{}(u);
    EXPECT_NEAR(normal_probability(z) / u, 1, 1e-5) << u;
    EXPECT_NEAR(NormalQuantile{}(1 - u), -z, 1e-6 * std::abs(z) + 1e-7 + (u < 1e-6 ? 0.1 : 0)) << u;
  }
  EXPECT_EQ(NormalQuantile{}(0.5), 0);
}

/// Returns the probability of at most k events: the smallest u whose quantile exceeds k, by bisection.
template <class Quantile>
double probability_up_to(Quantile const& quantile, double k) {
  double low = 1e-12, high = 1 - 1e-12;
  for (int i = 0; i < 60; ++i) {
    double const u = 0.5 * (low + high);
    (quantile(u) > k ? high : low) = u;
  }
  return low;
}

// Cumulative probabilities against sums of m^k e^-m / k!. The sums of small means are exact up to rounding. Those of
// the expansion have the error of its docstring, 2e-5 (16 / m)^2, besides the 1e-7 of the normal quantile.
TEST(PoissonQuantile, HasTheCumulativeProbabilities) {
  for (double const mean : {0.05, 1.0, 7.5, 15.99, 16.0, 40.0, 300.0, 3000.0}) {
    bool const summed = mean < PoissonQuantile::least_expanded;
    double const tolerance = summed ? 1e-12 : 2e-5 * std::pow(16 / mean, 2) + 2e-7;
    double exact = 0;
    for (double k = 0; k < mean + 5 * std::sqrt(mean) + 3; ++k) {
      exact += std::exp(k * std::log(mean) - mean - std::lgamma(k + 1));
      if (k < mean - 5 * std::sqrt(mean)) continue;
      double const found = probability_up_to([mean](double u) { return draw_electrons(mean, u); }, k);
      EXPECT_NEAR(found, std::min(exact, 1 - 1e-12), tolerance) << k << " of mean " << mean;
    }
  }
}

// 2^18 pixels of each mean charge, one level per electron: the numbers of pixels with each charge agree with Poisson's
// distribution by the chi-square test, within four of its standard deviations, and so do mean, variance and third
// moment, whose standard errors follow from the central moments of the distribution. Every block of pixels contains all
// four means. One case in 16,000 would fail by chance; since the noise is keyed, none does.
TEST(PixelBlocks, HaveTheStatisticsOfPoissonCharges) {
  constexpr int side = 1024;
  CameraSetup camera;
  camera.bit_depth = 16;
  camera.noise.enabled = true;
  camera.noise.read_noise_e = 0;
  camera.noise.full_well_e = 65535;
  double const means[4] = {0.4, 6, 23, 900};
  Image<double> light(side, side);
  for (std::size_t i = 0; i < light.size(); ++i) light.data()[i] = means[(i / 3) % 4];
  Recording const recording = Detector(camera, 1).record(light, RandomStream::noise_reference);
  for (std::size_t kind = 0; kind < 4; ++kind) {
    double const m = means[kind];
    std::vector<double> pixels(2000);  // with each number of electrons
    double count = 0, sum = 0, square = 0, cube = 0;
    for (std::size_t i = 0; i < light.size(); ++i) {
      if ((i / 3) % 4 != kind) continue;
      double const k = recording.image.data()[i], off = k - m;
      pixels.at(static_cast<std::size_t>(k)) += 1;
      count += 1;
      sum += off;
      square += off * off;
      cube += off * off * off;
    }
    EXPECT_NEAR(sum / count, 0, 4 * std::sqrt(m / count)) << m;
    EXPECT_NEAR(square / count, m, 4 * std::sqrt((m + 2 * m * m) / count)) << m;  // fourth moment: m + 3 m^2
    double const sixth = m + 25 * m * m + 15 * m * m * m;
    EXPECT_NEAR(cube / count, m, 4 * std::sqrt((sixth - m * m) / count)) << m;
    double chi_square = 0, bins = 0, expected = 0, seen = 0;
    for (std::size_t k = 0; k < pixels.size(); ++k) {
      expected += count * std::exp(static_cast<double>(k) * std::log(m) - m - std::lgamma(static_cast<double>(k) + 1));
      seen += pixels[k];
      if (expected < 20 && k + 1 < pixels.size()) continue;
      chi_square += (seen - expected) * (seen - expected) / std::max(expected, 1.0);
      bins += 1;
      expected = seen = 0;
    }
    EXPECT_NEAR(chi_square, bins - 1, 4 * std::sqrt(2 * bins)) << m;
  }
}

TEST(PoissonQuantile, LeavesNoChargeAndHugeChargesAlone) {
  EXPECT_EQ(draw_electrons(0, 0.999), 0);
  EXPECT_EQ(draw_electrons(-3, 0.5), -3);
  EXPECT_EQ(draw_electrons(2e12, 0.1), 2e12);
}

// Blocks of pixels are recorded by other loops than a single pixel, with the same result, for means on both sides of
// every change of method, with all kinds of noise.
TEST(PixelBlocks, RecordLikeSinglePixels) {
  CameraSetup camera;
  camera.bit_depth = 12;
  camera.noise.enabled = true;
  camera.background.level_e = 3;
  camera.columns = 70;
  camera.rows = 31;
  for (bool const patterned : {false, true}) {
    if (patterned) camera.noise.prnu = 0.02;
    if (patterned) camera.noise.hot_pixel_share = 0.05;
    if (patterned) camera.noise.hot_pixel_e = 100;
    Detector const detector(camera, 1000);
    Image<double> light(camera.columns, camera.rows);
    for (std::size_t i = 0; i < light.size(); ++i) light.data()[i] = 40 * std::pow(static_cast<double>(i % 97) / 97, 6);
    Recording const recording = detector.record(light, RandomStream::noise_flow);
    std::size_t saturated = 0;
    for (std::size_t i = 0; i < light.size(); ++i) {
      PixelLevel const one = detector.pixel().record(light.data()[i], RandomStream::noise_flow, i);
      EXPECT_EQ(recording.image.data()[i], one.level) << i;
      saturated += one.saturated ? 1 : 0;
    }
    EXPECT_EQ(recording.saturated, saturated);
    EXPECT_GT(saturated, 0u);
  }
}

}  // namespace
}  // namespace gladstone
