#include "analysis/tracking/photon_noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "render/base/random_variates.h"

namespace gladstone::inline tracking {
namespace {

/// Squared normal errors with the variance n0^2 + g L + m^2 F^2 on pixels with 2 to 50 % of fluxes F from 10 to 10^4
/// grey levels, both uniform in the logarithm.
std::vector<ResidualSample> sample(double n0, double gain, double mismatch, std::size_t count = 20000) {
  KeyedEngine random(3, RandomStream::sensor, 0);
  std::vector<ResidualSample> samples;
  for (std::size_t i = 0; i < count; ++i) {
    double const flux = std::pow(10.0, 1 + 3 * to_unit(random()));
    double const light = flux * 0.02 * std::pow(25.0, to_unit(random()));
    double const variance = n0 * n0 + gain * light + std::pow(mismatch * flux, 2);
    samples.push_back({light, flux, variance * std::pow(normal_variate(random), 2)});
  }
  return samples;
}

// The median of 10^4 squares scatters by 2 %; half of the pixels, those of the fainter dots, determine the gain.
TEST(PhotonNoise, RecoversTheGain) {
  EXPECT_NEAR(estimate_conversion_gain(sample(0.5, 0.14, 0), 0.5), 0.14, 0.014);
  EXPECT_NEAR(estimate_conversion_gain(sample(0.5, 0.14, 0.002), 0.5), 0.14, 0.02);
}

// With a tenth of the squares from undetected dots, a thousand times as large, the median is the 56 % quantile of chi2,
// 0.58 instead of 0.45, of which the background noise takes no part.
TEST(PhotonNoise, IsRobustAgainstUndetectedDots) {
  std::vector<ResidualSample> samples = sample(0.5, 0.14, 0);
  for (std::size_t i = 0; i < samples.size(); i += 10) samples[i].square *= 1000;
  EXPECT_NEAR(estimate_conversion_gain(samples, 0.5), 0.14, 0.09);
}

TEST(PhotonNoise, IsZeroWithoutShotNoise) {
  EXPECT_EQ(estimate_conversion_gain(sample(0.5, 0, 0), 0.5), 0);
  EXPECT_EQ(estimate_conversion_gain(sample(0.5, 0, 0.01), 0.5), 0);
  EXPECT_EQ(estimate_conversion_gain(sample(0.5, 0.14, 0, 150), 0.5), 0) << "too few pixels";
  EXPECT_EQ(estimate_conversion_gain({}, 0.5), 0);
}

}  // namespace
}  // namespace gladstone::inline tracking
