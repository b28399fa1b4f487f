#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/base/error.h"
#include "render/files/image_file.h"
#include "render/sensor/detector.h"
#include "render/setup/setup_table.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

/// A camera with one grey level per electron, without shot noise and read noise.
CameraSetup counting_camera(int columns, int rows) {
  CameraSetup camera;
  camera.columns = columns;
  camera.rows = rows;
  camera.bit_depth = 16;
  camera.noise.full_well_e = 65535;
  camera.noise.read_noise_e = 0;
  camera.noise.shot_noise = false;
  return camera;
}

CameraSetup patterned_camera() {
  CameraSetup camera = counting_camera(300, 300);
  camera.noise.enabled = true;
  camera.offset_dn = 1000;
  return camera;
}

Image<std::uint16_t> recorded(CameraSetup const& camera, double light_e,
                              RandomStream stream = RandomStream::noise_reference) {
  return Detector(camera, light_e).record(Image<double>(camera.columns, camera.rows, 1.0), stream).image;
}

double mean_of(Image<std::uint16_t> const& image) {
  double sum = 0;
  for (auto const level : image) sum += level;
  return sum / static_cast<double>(image.size());
}

double deviation_of(Image<std::uint16_t> const& image) {
  double const mean = mean_of(image);
  double sum = 0;
  for (auto const level : image) sum += (level - mean) * (level - mean);
  return std::sqrt(sum / static_cast<double>(image.size() - 1));
}

// Level at the image centre, and its increase from the first to the last column (row); light is added to it.
TEST(Background, IsALevelAndAGradient) {
  CameraSetup camera = counting_camera(5, 3);
  camera.background.level_e = 500;
  camera.background.gradient_e = {400, -100};
  Image<std::uint16_t> const image = recorded(camera, 30);
  for (int row = 0; row < 3; ++row) {
    for (int column = 0; column < 5; ++column) {
      EXPECT_EQ(image(column, row), 530 + 100 * (column - 2) - 50 * (row - 1));
    }
  }
  // contains the light of the sources only
  EXPECT_DOUBLE_EQ(Detector(camera, 30).ideal_level(1.0), 30);
}

// A ramp of four pixels is stretched over eight: the pixel centres of the ramp are at 0.5, 2.5, 4.5 and 6.5 of the
// sensor, and the glare is constant beyond the outermost ones. The brightest pixel of the ramp corresponds to glare_e.
TEST(Background, StretchesAGlareOverTheSensor) {
  std::string const path = testing::TempDir() + "/glare.tif";
  Image<std::uint16_t> ramp(4, 1);
  for (int i = 0; i < 4; ++i) ramp(i, 0) = static_cast<std::uint16_t>(100 * (i + 1));
  write_tiff(path, ramp, {});
  CameraSetup camera = counting_camera(8, 2);
  camera.background.glare_file = path;
  camera.background.glare_e = 8000;
  Image<std::uint16_t> const image = recorded(camera, 0);
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 8; ++column) {
      EXPECT_EQ(image(column, row), 2000 * (1 + std::clamp((column + 0.5) / 2 - 0.5, 0.0, 3.0)));
    }
  }
  write_tiff(path, Image<std::uint16_t>(4, 4), {});
  EXPECT_THAT([&] { Detector detector(camera, 1); }, ThrowsDataError(ErrorCode::invalid_value, path));
}

// The background has shot noise like any other light, with a variance equal to its mean. Tolerance: five standard
// errors of a variance.
TEST(Background, HasShotNoise) {
  CameraSetup camera = patterned_camera();
  camera.noise.shot_noise = true;
  camera.background.level_e = 900;
  double const variance = std::pow(deviation_of(recorded(camera, 100)), 2);
  EXPECT_NEAR(variance, 1000 + 1.0 / 12, 5 * 1000 * std::sqrt(2.0 / 90000));
}

// A relative gain deviation of 2 % makes pixels at 20000 electrons differ by 400 electrons rms; black levels differ by
// 30 electrons rms at any light. Both patterns are the same in both frames. Tolerance: five standard errors of a
// standard deviation.
TEST(FixedPattern, ScalesTheLightAndShiftsTheDark) {
  CameraSetup camera = patterned_camera();
  double const error = 5 / std::sqrt(2.0 * 90000);
  camera.noise.prnu = 0.02;
  Image<std::uint16_t> const bright = recorded(camera, 20000), dim = recorded(camera, 2000);
  EXPECT_NEAR(deviation_of(bright), 400, 400 * error);
  EXPECT_NEAR(mean_of(bright), 21000, 5 * 400 / 300.0);
  // The gains do not depend on the light: a tenth of the light shows a tenth of the deviation, apart from rounding of
  // both.
  for (std::size_t i = 0; i < bright.size(); ++i) {
    EXPECT_NEAR(dim.data()[i] - 1000.0, (bright.data()[i] - 1000.0) / 10, 0.55 + 1e-9);
  }
  camera.noise.prnu = 0;
  camera.noise.dsnu_e = 30;
  Image<std::uint16_t> const dark = recorded(camera, 0), later = recorded(camera, 0, RandomStream::noise_flow);
  EXPECT_NEAR(deviation_of(dark), 30, 30 * error);
  EXPECT_TRUE(std::equal(dark.begin(), dark.end(), later.begin()));
  Image<std::uint16_t> const lit = recorded(camera, 5000);
  for (std::size_t i = 0; i < dark.size(); ++i) EXPECT_EQ(lit.data()[i] - dark.data()[i], 5000);
  camera.noise.pattern_seed = 2;
  Image<std::uint16_t> const other = recorded(camera, 0);
  EXPECT_FALSE(std::equal(dark.begin(), dark.end(), other.begin()));
}

// 1 % of the pixels, 900 of 90000, have an exponentially distributed charge. Tolerance: four standard deviations of the
// number, and four of the mean charge. The pattern of black levels does not change which pixels are hot.
TEST(HotPixels, AreAShareOfAllWithAnExponentialCharge) {
  CameraSetup camera = patterned_camera();
  camera.noise.hot_pixel_share = 0.01;
  camera.noise.hot_pixel_e = 5000;
  auto const hot_of = [](Image<std::uint16_t> const& image) {
    std::vector<double> charges;
    for (auto const level : image) {
      if (level > 1000) charges.push_back(level - 1000.0);
    }
    return charges;
  };
  Image<std::uint16_t> const image = recorded(camera, 0);
  std::vector<double> const charges = hot_of(image);
  auto const count = static_cast<double>(charges.size());
  EXPECT_NEAR(count, 900, 4 * std::sqrt(900.0));
  double mean = 0;
  for (double const charge : charges) mean += charge / count;
  EXPECT_NEAR(mean, 5000, 4 * 5000 / std::sqrt(count));
  Image<std::uint16_t> const later = recorded(camera, 0, RandomStream::noise_flow);
  EXPECT_TRUE(std::equal(image.begin(), image.end(), later.begin()));
  camera.noise.prnu = 0.02;
  EXPECT_EQ(hot_of(recorded(camera, 0)).size(), charges.size());
}

TEST(CameraSetup, RefusesABackgroundThatHidesAll) {
  auto const read = [](std::string const& text) {
    SetupDocument document = SetupDocument::from_text(text, "case.toml");
    CameraSetup const camera = read_camera_setup(document.root());
    document.finish();
    return camera;
  };
  CameraSetup const good =
      read("background.level_e = 300\nbackground.gradient_e = [50, -70]\nnoise.prnu_percent = 1.5");
  EXPECT_EQ(good.background.most_e(), 360);
  EXPECT_DOUBLE_EQ(good.noise.prnu, 0.015);
  EXPECT_THAT([&] { read("background.level_e = 29000"); },
              testing::AllOf(ThrowsSetupError(ErrorCode::invalid_value, "background.level_e"),
                             testing::ThrowsMessage<SetupError>(testing::HasSubstr("24000"))));
  EXPECT_THAT([&] { read("background.glare_e = 5"); },
              ThrowsSetupError(ErrorCode::invalid_value, "background.glare_e"));
  EXPECT_THAT([&] { read("background.glare_file = \"absent.png\""); },
              ThrowsSetupError(ErrorCode::missing_file, "background.glare_file"));
  EXPECT_THAT([&] { read("noise.hot_pixel_share = 2"); },
              ThrowsSetupError(ErrorCode::out_of_range, "noise.hot_pixel_share"));
  EXPECT_THAT([&] { read("bit_depth = 18"); }, ThrowsSetupError(ErrorCode::out_of_range, "bit_depth"));
}

}  // namespace
}  // namespace gladstone
