#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/sensor/detector.h"

namespace gladstone {
namespace {

double normal_below(double t) { return 0.5 * std::erfc(-t / std::sqrt(2.0)); }

/// Mean and variance of a grey level.
struct LevelMoments {
  double mean = 0, variance = 0;
};

/// Computes the moments of one pixel's grey level from its definition: the number of electrons k is Poisson
/// distributed; level = floor(offset + gain (k + read noise) + 1/2), clipped to [0, full scale]. The mean of a
/// non-negative integer is the sum over levels of the probability to reach them; the mean square is the same sum with
/// weights 2 level - 1.
LevelMoments exact_level(CameraSetup const& camera, double electrons) {
  double const full = std::pow(2.0, camera.bit_depth) - 1, gain = full / camera.noise.full_well_e;
  double const sigma = gain * camera.noise.read_noise_e;
  auto const reaches = [&](double level, double charge) {
    double const above = camera.offset_dn + gain * charge - (level - 0.5);
    return sigma > 0 ? normal_below(above / sigma) : (above >= 0 ? 1.0 : 0.0);
  };
  double mean = 0, square = 0;
  double const most = electrons + 12 * std::sqrt(electrons) + 30;
  for (double k = 0; k <= most; ++k) {
    double const chance = electrons > 0 ? std::exp(k * std::log(electrons) - electrons - std::lgamma(k + 1)) : k == 0;
    double const highest = std::min(full, camera.offset_dn + gain * k + 9 * sigma + 1);
    for (double level = 1; level <= highest; ++level) {
      double const reached = chance * reaches(level, k);
      mean += reached;
      square += (2 * level - 1) * reached;
    }
  }
  return {mean, square - mean * mean};
}

/// Returns the mean grey level of repeated recordings of a flat field.
double recorded_mean(CameraSetup camera, double electrons, int frames, int side) {
  Image<double> const flat(side, side, electrons / 10000);
  double sum = 0;
  for (int frame = 0; frame < frames; ++frame) {
    camera.noise.seed = static_cast<std::uint64_t>(frame) + 11;
    Recording const recording = Detector(camera, 10000).record(flat, RandomStream::noise_flow);
    for (auto const level : recording.image) sum += level;
  }
  return sum / (static_cast<double>(frames) * side * side);
}

// At a few electrons per pixel, read noise, shot noise, rounding and clipping at zero interact. The mean level of
// 262,144 pixels agrees with the exact one within four standard errors, about 0.001 to 0.1 levels, with and without a
// black level. One case in 16,000 would fail by chance; since the noise is keyed, none does.
TEST(LowLight, TheMeanLevelIsThatOfPoissonReadNoiseRoundingAndBlack) {
  struct Camera {
    int bits;
    double full_well_e, read_noise_e;
  };
  for (Camera const& kind : {Camera{8, 30000, 3},
                             {12, 30000, 3},
                             {12, 3000, 3},
                             {12, 300, 1},
                             {10, 20000, 0},
                             {14, 10000, 12},
                             {16, 30000, 3}}) {
    for (double const offset : {0.0, 40.0}) {
      CameraSetup camera;
      camera.bit_depth = kind.bits;
      camera.offset_dn = offset;
      camera.noise.enabled = true;
      camera.noise.full_well_e = kind.full_well_e;
      camera.noise.read_noise_e = kind.read_noise_e;
      for (double const electrons : {0.0, 0.3, 2.0, 9.0, 11.0, 40.0}) {
        LevelMoments const exact = exact_level(camera, electrons);
        int const frames = 4, side = 256;
        // the variance of a constant level is a difference of rounded squares and may be negative
        double const error = std::sqrt(std::max(0.0, exact.variance) / (frames * side * side));
        EXPECT_NEAR(recorded_mean(camera, electrons, frames, side), exact.mean, 4 * error + 1e-9)
            << kind.bits << " bits, " << kind.full_well_e << " e, read noise " << kind.read_noise_e << " e, offset "
            << offset << ", " << electrons << " electrons";
      }
    }
  }
}

// With a black level of four standard deviations of the read noise, the mean is gain times electrons to within a
// thousandth of a level. Without a black level, dim pixels are too bright by 0.1 to 0.5 levels at a few electrons, due
// to the clipping at zero alone.
TEST(LowLight, DimPixelsAreBiasedByBlackClippingOnly) {
  CameraSetup camera;
  camera.bit_depth = 12;
  camera.noise.enabled = true;
  camera.noise.full_well_e = 10000;
  camera.noise.read_noise_e = 5;
  double const gain = 4095.0 / 10000;
  double last = clipped_at_black(camera);
  EXPECT_NEAR(exact_level(camera, 0).mean, last, 1e-9);
  EXPECT_NEAR(last, 5 * gain / std::sqrt(2 * 3.14159265358979), 0.03);  // value for a continuous level
  for (double const electrons : {1.0, 2.0, 4.0, 8.0}) {
    double const excess = exact_level(camera, electrons).mean - gain * electrons;
    EXPECT_GT(excess, 0.005) << electrons;
    EXPECT_LT(excess, last) << electrons;
    last = excess;
  }
  camera.offset_dn = std::ceil(4 * 5 * gain);
  EXPECT_LT(clipped_at_black(camera), 1e-4);
  for (double const electrons : {0.0, 1.0, 2.0, 4.0, 8.0}) {
    EXPECT_NEAR(exact_level(camera, electrons).mean, camera.offset_dn + gain * electrons, 1e-3) << electrons;
  }
}

TEST(LowLight, ReportsBlackClippingAtAnyNoise) {
  CameraSetup camera;
  EXPECT_EQ(clipped_at_black(camera), 0.0);  // without noise, no level is clipped at zero
  camera.noise.enabled = true;
  camera.noise.read_noise_e = 0;
  EXPECT_EQ(clipped_at_black(camera), 0.0);
  // for large noise, the mean positive part of a normal variate is sigma / sqrt(2 pi); the sum approaches this value
  camera.noise.full_well_e = 65535;
  for (double const electrons : {99.0, 101.0, 1e6}) {
    camera.noise.read_noise_e = electrons;
    EXPECT_NEAR(clipped_at_black(camera), electrons / std::sqrt(2 * 3.14159265358979), 1e-3 * electrons);
  }
  // dark electrons raise the level: a read noise of 3 e around a mean of 100 e never reaches zero
  camera.noise.read_noise_e = 3;
  camera.noise.dark_current_e = 100;
  EXPECT_LT(clipped_at_black(camera), 1e-15);
}

}  // namespace
}  // namespace gladstone
