#include "render/sensor/pixel_noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/sensor/detector.h"

namespace gladstone {
namespace {

double normal_probability(double z) { return 0.5 * std::erfc(-z / std::sqrt(2.0)); }

// The quantile is the inverse of the distribution. Its relative error of 1.2e-7 changes z by up to 1e-6 at 8 standard
// deviations, and hence a probability p by z p 1e-6 at most.
TEST(NormalQuantile, IsTheInverseOfTheDistribution) {
  for (double const u : {1e-15, 1e-11, 3e-6, 0.001, 0.0749, 0.0751, 0.2, 0.5, 0.7, 0.9249, 0.9251, 0.9999}) {
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
