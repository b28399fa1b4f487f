#include "render/sensor/detector.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <vector>

#include "render/base/parallel.h"
#include "render/sensor/camera_setup.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

CameraSetup ideal_camera(int bits, double offset = 0) {
  CameraSetup camera;
  camera.bit_depth = bits;
  camera.offset_dn = offset;
  return camera;
}

CameraSetup noisy_camera() {
  CameraSetup camera = ideal_camera(12, 100);
  camera.noise.enabled = true;
  camera.noise.full_well_e = 20000;
  camera.noise.read_noise_e = 12;
  camera.noise.dark_current_e = 40;
  return camera;
}

struct Moments {
  double mean = 0, variance = 0;
};
Moments moments(Image<std::uint16_t> const& image) {
  Moments m;
  for (auto const value : image) m.mean += value / static_cast<double>(image.size());
  for (auto const value : image)
    m.variance += (value - m.mean) * (value - m.mean) / static_cast<double>(image.size() - 1);
  return m;
}

// Grey level = offset + light * electrons * full scale / full well, rounded.
TEST(Detector, AnIdealSensorRoundsToItsBitDepth) {
  Image<double> light(3, 1);
  light(0, 0) = 0, light(1, 0) = 0.5, light(2, 0) = 1.0;
  for (int const bits : {8, 10, 12, 16}) {
    double const full = std::pow(2.0, bits) - 1, offset = 5;
    CameraSetup const camera = ideal_camera(bits, offset);
    Detector const detector(camera, 0.8 * camera.noise.full_well_e);
    EXPECT_EQ(detector.pixel().full_scale, full);
    EXPECT_NEAR(detector.pixel().electrons * detector.pixel().levels_per_electron, 0.8 * full, 1e-9);
    EXPECT_NEAR(detector.ideal(light)(1, 0), offset + 0.4 * full, 1e-9);
    Recording const recording = detector.record(light, RandomStream::noise_reference);
    EXPECT_EQ(recording.image(0, 0), 5);
    EXPECT_EQ(recording.image(1, 0), std::floor(offset + 0.4 * full + 0.5));
    EXPECT_EQ(recording.image(2, 0), std::floor(offset + 0.8 * full + 0.5));
    EXPECT_EQ(recording.saturated, 0u);
  }
}

TEST(Detector, SaturationIsClippedAndCounted) {
  Image<double> light(4, 1, 0.5);
  light(1, 0) = 1.2;
  light(3, 0) = 100;
  CameraSetup const ideal = ideal_camera(8);
  Recording const recording = Detector(ideal, ideal.noise.full_well_e).record(light, RandomStream::noise_flow);
  EXPECT_EQ(recording.saturated, 2u);
  EXPECT_EQ(recording.image(1, 0), 255);
  EXPECT_EQ(recording.image(3, 0), 255);
  EXPECT_EQ(recording.image(0, 0), 128);

  // a pixel at full well counts as saturated although read noise changes its level
  CameraSetup const noisy = noisy_camera();
  EXPECT_EQ(Detector(noisy, noisy.noise.full_well_e).record(light, RandomStream::noise_flow).saturated, 2u);
}

// Photon transfer: the number of electrons is Poisson distributed with mean m = light + dark; read noise r is added;
// the gain is k levels per electron; rounding adds 1/12. Hence mean = offset + k m and variance = k^2 (m + r^2) + 1/12.
// For n = 40000 pixels, the standard deviation of the mean is sqrt(variance/n) and that of the variance is variance
// sqrt((2 + 1/m)/n) (kurtosis of a Poisson distribution). Tolerance: five standard deviations.
TEST(Detector, PhotonTransferIsGainTimesMeanPlusReadNoise) {
  CameraSetup const camera = noisy_camera();
  Detector const detector(camera, 10000);
  double const k = 4095.0 / 20000;
  for (double const light : {0.0, 0.003, 0.1, 0.5, 1.0}) {
    Image<double> const flat(200, 200, light);
    Moments const m = moments(detector.record(flat, RandomStream::noise_reference).image);
    double const electrons = light * 10000 + 40;
    double const variance = k * k * (electrons + 144) + 1.0 / 12;
    EXPECT_NEAR(m.mean, 100 + k * electrons, 5 * std::sqrt(variance / 40000)) << light;
    EXPECT_NEAR(m.variance, variance, 5 * variance * std::sqrt((2 + 1 / electrons) / 40000)) << light;
  }
}

// Without shot noise, only read noise and rounding remain at any light.
TEST(Detector, ShotNoiseCanBeSwitchedOff) {
  CameraSetup camera = noisy_camera();
  camera.noise.shot_noise = false;
  double const k = 4095.0 / 20000, variance = k * k * 144 + 1.0 / 12;
  Moments const m =
      moments(Detector(camera, 10000).record(Image<double>(200, 200, 1.0), RandomStream::noise_flow).image);
  EXPECT_NEAR(m.variance, variance, 5 * variance * std::sqrt(2.0 / 40000));
}

// The noise of the two frames, and of neighbouring pixels, is uncorrelated within 5/sqrt(n).
TEST(Detector, NoiseIsIndependentBetweenFramesAndPixelsAndRepeatsBySeed) {
  CameraSetup camera = noisy_camera();
  Image<double> const flat(200, 200, 0.5);
  Detector const detector(camera, 10000);
  auto const a = detector.record(flat, RandomStream::noise_reference).image;
  auto const b = detector.record(flat, RandomStream::noise_flow).image;
  Moments const ma = moments(a), mb = moments(b);
  double frames = 0, neighbours = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    frames += (a.data()[i] - ma.mean) * (b.data()[i] - mb.mean) / std::sqrt(ma.variance * mb.variance) / 40000;
    neighbours += (a.data()[i] - ma.mean) * (a.data()[(i + 1) % a.size()] - ma.mean) / ma.variance / 40000;
  }
  EXPECT_NEAR(frames, 0, 5.0 / 200);
  EXPECT_NEAR(neighbours, 0, 5.0 / 200);

  auto const again = detector.record(flat, RandomStream::noise_reference).image;
  EXPECT_TRUE(std::equal(a.begin(), a.end(), again.begin()));
  camera.noise.seed = 2;
  auto const other = Detector(camera, 10000).record(flat, RandomStream::noise_reference).image;
  EXPECT_FALSE(std::equal(a.begin(), a.end(), other.begin()));
}

TEST(Detector, RecordsTheSameBitsOnAnyNumberOfThreads) {
  Image<double> light(333, 71);
  for (std::size_t i = 0; i < light.size(); ++i) light.data()[i] = 0.5 + 0.49 * std::sin(static_cast<double>(i));
  Detector const detector(noisy_camera(), 20000);
  set_thread_count(1);
  Recording const one = detector.record(light, RandomStream::noise_flow);
  for (int const threads : {2, 7}) {
    set_thread_count(threads);
    Recording const many = detector.record(light, RandomStream::noise_flow);
    EXPECT_TRUE(std::equal(one.image.begin(), one.image.end(), many.image.begin())) << threads;
    EXPECT_EQ(one.saturated, many.saturated);
  }
  set_thread_count(0);
}

// The brightest noise-free pixel is at 90 % of full scale, including the black level.
TEST(Detector, AutoExposurePutsTheBrightestPixelAtNinetyPercent) {
  for (double const offset : {0.0, 200.0}) {
    CameraSetup const camera = ideal_camera(12, offset);
    Detector const detector(camera, Detector::auto_exposure(camera, 3.7));
    EXPECT_NEAR(detector.ideal_level(3.7), 0.9 * 4095, 1e-9);
    EXPECT_NEAR(detector.ideal_level(0), offset, 1e-12);
  }
  CameraSetup const camera = ideal_camera(12);
  EXPECT_GT(Detector::auto_exposure(camera, 0.0), 0);  // the exposure of a black frame is positive, too
}

TEST(CameraSetup, NoiseIsOffUnlessItsTableIsThere) {
  auto const read = [](std::string const& text) {
    SetupDocument document = SetupDocument::from_text(text, "camera.toml");
    CameraSetup const setup = read_camera_setup(document.root().table("camera"));
    document.finish();
    return setup;
  };
  EXPECT_FALSE(read("").noise.enabled);
  EXPECT_FALSE(read("").exposure_e);
  CameraSetup const noisy = read("[camera]\nexposure = 5000\npixel_pitch_um = 5.5\n[camera.noise]\nread_noise_e = 7\n");
  EXPECT_TRUE(noisy.noise.enabled);
  EXPECT_EQ(noisy.noise.read_noise_e, 7);
  EXPECT_EQ(noisy.noise.full_well_e, 30000);
  EXPECT_EQ(noisy.exposure_e, 5000);
  EXPECT_DOUBLE_EQ(noisy.pixel_pitch, 5.5e-6);
  EXPECT_THAT([&] { read("[camera]\npixels = [0, 512]\n"); },
              ThrowsSetupError(ErrorCode::out_of_range, "camera.toml:2:1"));
  EXPECT_THAT([&] { read("[camera]\npixel_pitch_um = -1\n"); },
              ThrowsSetupError(ErrorCode::out_of_range, "camera.pixel_pitch_um"));
  EXPECT_THAT([&] { read("[camera]\nbit_depth = 17\n"); },
              ThrowsSetupError(ErrorCode::out_of_range, "camera.bit_depth"));
}

// In a sequence, the noise of a frame depends on its number only: frame 4 is the same as the second frame of a pair and
// as the first one of the next. Frames of different numbers are independent.
TEST(Detector, KeysTheNoiseOfASequenceByFrame) {
  Image<double> const light(64, 64, 0.5);
  CameraSetup camera = noisy_camera();
  auto const record = [&](std::uint64_t first, std::uint64_t second, RandomStream stream) {
    camera.noise.frames = std::array<std::uint64_t, 2>{first, second};
    auto const image = Detector(camera, 10000).record(light, stream).image;
    return std::vector<std::uint16_t>(image.begin(), image.end());
  };
  auto const frame = record(3, 4, RandomStream::noise_flow);
  EXPECT_EQ(frame, record(4, 5, RandomStream::noise_reference));
  EXPECT_EQ(frame, record(0, 4, RandomStream::noise_flow));
  for (auto const& other : {record(3, 4, RandomStream::noise_reference), record(4, 5, RandomStream::noise_flow)}) {
    double product = 0;
    double const mean_level = moments(Detector(camera, 10000).record(light, RandomStream::noise_flow).image).mean;
    for (std::size_t i = 0; i < frame.size(); ++i) product += (frame[i] - mean_level) * (other[i] - mean_level);
    // the correlation coefficient of independent noise is below 5 / sqrt(number of pixels)
    double const variance = moments(Detector(camera, 10000).record(light, RandomStream::noise_flow).image).variance;
    EXPECT_LT(std::abs(product) / (static_cast<double>(frame.size()) * variance), 5.0 / 64);
  }
}

}  // namespace
}  // namespace gladstone
