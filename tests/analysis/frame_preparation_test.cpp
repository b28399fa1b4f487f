#include "analysis/preparation/frame_preparation.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "analysis/correlation/correlator.h"
#include "analysis/preparation/frame_changes.h"
#include "render/base/error.h"
#include "render/base/units.h"
#include "render/files/image_file.h"
#include "studies/benchmark/particle_pair.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

using ::testing::HasSubstr;

HostFrames with_mask(Image<double> const& reference, Image<double> const& flow, FrameChange mask) {
  FramePreparation preparation;
  preparation.masks.push_back(std::move(mask));
  return prepare_frames(HostFrames(reference, flow), preparation);
}

HostFrames with_step(Image<double> const& reference, Image<double> const& flow, FrameChange step) {
  FramePreparation preparation;
  preparation.steps.push_back(std::move(step));
  return prepare_frames(HostFrames(reference, flow), preparation);
}

Image<double> picture_of(int side, std::function<double(int, int)> const& level) {
  Image<double> picture(side, side);
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) picture(i, j) = level(i, j);
  return picture;
}

// A rectangle between pixel centres contains a countable number of them; a triangle with corners (0, 0), (40, 0), (0,
// 40), shifted by less than a pixel, contains those with i + j < 40.
TEST(PolygonMask, LeavesOutThePixelsInside) {
  Image<double> const frame(64, 64, 5.0);
  HostFrames const box =
      with_mask(frame, frame, make_polygon_mask({{9.5, 4.5}, {19.5, 4.5}, {19.5, 14.5}, {9.5, 14.5}}));
  HostFrames const corner = with_mask(frame, frame, make_polygon_mask({{-0.3, -0.3}, {39.7, -0.3}, {-0.3, 39.7}}));
  for (int j = 0; j < 64; ++j)
    for (int i = 0; i < 64; ++i) {
      EXPECT_EQ(std::isnan(box.reference()(i, j)), i >= 10 && i < 20 && j >= 5 && j < 15) << i << ' ' << j;
      EXPECT_EQ(std::isnan(corner.flow()(i, j)), i + j < 40) << i << ' ' << j;
    }
  EXPECT_DOUBLE_EQ(valid_pixel_fraction(box), 1.0 - 100.0 / 4096.0);
}

TEST(ImageMask, LeavesOutWhereThePictureIsBlack) {
  std::string const file = ::testing::TempDir() + "gladstone_mask.tif";
  Image<std::uint16_t> mask(32, 32, 255);
  for (int j = 0; j < 32; ++j) mask(7, j) = 0;
  write_tiff(file, mask, {});
  Image<double> const frame(32, 32, 5.0);
  HostFrames const frames = with_mask(frame, frame, make_image_mask(file));
  for (int i = 0; i < 32; ++i) EXPECT_EQ(std::isnan(frames.flow()(i, 3)), i == 7);
  Image<double> const other(30, 32, 5.0);
  EXPECT_THROW(with_mask(other, other, make_image_mask(file)), DataError);
  std::filesystem::remove(file);
}

// A mask pixel of NaN means neither "masked" nor "not masked"; a background pixel of NaN is not a grey level.
TEST(ImageMask, ThatHasPixelsWhichAreNoNumbersIsRefused) {
  std::string const file = GLADSTONE_DATA_DIR "/../tests/cases/pictures/mask_nan.tif";
  Image<double> const frame(7, 5, 5.0);
  for (FrameChange const& change : {make_image_mask(file), make_background_subtraction("minimum", {file}, {file})}) {
    EXPECT_THAT([&] { with_mask(frame, frame, change); },
                ThrowsDataError(ErrorCode::invalid_value, "mask_nan.tif", HasSubstr("14 of 35")));
  }
}

// Pixels that are bright in one frame are masked in both; masked pixels remain masked.
TEST(IntensityMask, LeavesOutWhatIsBrightInEitherFrame) {
  Image<double> reference(32, 32, 10.0), flow = reference;
  reference(3, 4) = 200.0;
  flow(20, 21) = 201.0;
  flow(9, 9) = std::numeric_limits<double>::quiet_NaN();
  HostFrames const frames = with_mask(reference, flow, make_intensity_mask(199.5, {}, 0.0));
  EXPECT_TRUE(std::isnan(frames.flow()(3, 4)) && std::isnan(frames.reference()(20, 21)));
  EXPECT_TRUE(std::isnan(frames.reference()(9, 9)));
  EXPECT_DOUBLE_EQ(valid_pixel_fraction(frames), 1.0 - 3.0 / 1024.0);
  EXPECT_DOUBLE_EQ(valid_pixel_fraction(with_mask(reference, flow, make_intensity_mask({}, 500.0, 0.0))), 0.0);
}

// A Gaussian average of standard deviation sigma transmits exp(-2 pi^2 sigma^2/L^2) of a wave of length L; the
// high-pass filter leaves the remainder. OpenCV's kernel is truncated at four sigma, exp(-8) = 3e-4, and sampled.
TEST(HighPass, PassesOneMinusTheGaussianTransfer) {
  for (double const length : {16.0, 64.0}) {
    Image<double> const wave =
        picture_of(128, [&](int i, int) { return 100.0 + 50.0 * std::sin(2.0 * pi * i / length); });
    HostFrames const frames = with_step(wave, wave, make_high_pass(6.0));
    double const left = 1.0 - std::exp(-2.0 * pi * pi * 36.0 / (length * length));
    for (int i = 40; i < 88; ++i)
      EXPECT_NEAR(frames.reference()(i, 60), left * 50.0 * std::sin(2.0 * pi * i / length), 0.1) << length;
  }
}

// Light under a mask has no effect: a uniform image remains uniform up to the edge of the mask.
TEST(HighPass, LooksAtKnownPixelsAlone) {
  Image<double> const frame = picture_of(64, [](int i, int) { return i < 20 ? 4000.0 : 100.0; });
  FramePreparation preparation;
  preparation.masks.push_back(make_intensity_mask(1000.0, {}, 0.0));
  preparation.steps.push_back(make_high_pass(10.0));
  HostFrames const frames = prepare_frames(HostFrames(frame, frame), preparation);
  EXPECT_TRUE(std::isnan(frames.reference()(19, 5)));
  for (int i = 20; i < 64; ++i) EXPECT_NEAR(frames.reference()(i, 5), 0.0, 1e-9);
}

// One bright pixel of n: mean h/n, variance h^2 (n - 1)/n^2, median 0.
TEST(IntensityCap, IsTheMedianAndSomeDeviations) {
  Image<double> frame(20, 20, 0.0);
  frame(5, 6) = 1000.0;
  HostFrames const frames = with_step(frame, frame, make_intensity_cap(3.0));
  EXPECT_NEAR(frames.flow()(5, 6), 3.0 * 1000.0 * std::sqrt(399.0) / 400.0, 1e-9);
  EXPECT_EQ(frames.flow()(0, 0), 0.0);
}

// A gain and an offset of the illumination cancel in both. The brighter levels of up to 1815 are rounded to 1.2e-13;
// min_max divides two differences of them by at least 0.05 of their range of 1785: 4 * 1.2e-13 / 89 = 5e-15. CLAHE
// rounds to 16 bits, by which a level moves by a step. Its table rises by 65535/64^2 = 16 per pixel of a tile, and by
// up to two pixels per step: the limit of 2 times 64^2/65536 is less than one pixel, for which OpenCV uses one, and the
// redistributed rest adds another. The table and the level each move by a step: 2 * 2 * 16 = 64.
TEST(LocalContrast, DoesNotDependOnTheLight) {
  ParticlePair const pair = render_particle_pair({.columns = 128, .rows = 128}, [](Vec2d) { return Vec2d{}; });
  Image<double> bright = pair.flow;
  for (double& level : bright) level = 7.0 * level + 30.0;
  for (auto const& [name, step, tolerance] :
       {std::tuple("min_max", make_min_max(15, 0.05), 2e-14), std::tuple("clahe", make_clahe(64, 2.0), 64.0)}) {
    HostFrames const frames = with_step(pair.flow, bright, step);
    for (int j = 0; j < 128; ++j)
      for (int i = 0; i < 128; ++i)
        EXPECT_NEAR(frames.reference()(i, j), frames.flow()(i, j), tolerance) << name << ' ' << i << ' ' << j;
  }
}

double contrast_of(Image<double> const& frame, int first, int end) {
  double sum = 0.0, squares = 0.0, count = 0.0;
  for (int j = 0; j < frame.rows(); ++j)
    for (int i = first; i < end; ++i) {
      sum += frame(i, j);
      squares += frame(i, j) * frame(i, j);
      count += 1.0;
    }
  return std::sqrt(squares / count - sum * sum / (count * count));
}

// One half has an eighth of the light of the other: afterwards its contrast is at least twice that fraction of the
// contrast of the other.
TEST(LocalContrast, AmplifiesTheFaintHalf) {
  ParticlePair pair = render_particle_pair({.columns = 128, .rows = 128}, [](Vec2d) { return Vec2d{}; });
  for (int j = 0; j < 128; ++j)
    for (int i = 64; i < 128; ++i) pair.flow(i, j) /= 8.0;
  for (auto const& [name, step] :
       {std::pair("min_max", make_min_max(15, 0.01)), std::pair("clahe", make_clahe(32, 20.0))}) {
    HostFrames const frames = with_step(pair.flow, pair.flow, step);
    EXPECT_GT(contrast_of(frames.flow(), 76, 128), 0.25 * contrast_of(frames.flow(), 0, 52)) << name;
  }
}

// Dots move over a brighter pattern at rest: without background subtraction the windows find the pattern, with it the
// dots. The minimum of a sequence is the pattern alone if no pixel is always covered by a dot. The random error of a
// vector of ten dots is about 0.05 px, and the median of the 225 vectors has a fifteenth of it.
TEST(Background, SubtractsStationaryBackground) {
  auto const moved = [](std::uint64_t seed, Vec2d by) {
    return render_particle_pair({.particles_per_px = 10.0 / 1024.0, .seed = seed}, [by](Vec2d) { return by; });
  };
  ParticlePair const still = render_particle_pair({.seed = 99}, [](Vec2d) { return Vec2d{}; });
  std::string const folder = ::testing::TempDir();
  std::vector<std::string> files[2];
  Image<double> first[2];
  for (std::uint64_t seed = 1; seed <= 6; ++seed) {
    ParticlePair const dots = moved(seed, {2.0, -1.0});
    std::string const names[2] = {"gladstone_a" + std::to_string(seed) + ".tif",
                                  "gladstone_b" + std::to_string(seed) + ".tif"};
    for (int k = 0; k < 2; ++k) {
      Image<std::uint16_t> levels(256, 256);
      for (std::size_t i = 0; i < levels.size(); ++i)
        levels.data()[i] = static_cast<std::uint16_t>(
            std::lround((k == 0 ? dots.reference : dots.flow).data()[i] + 4.0 * still.reference.data()[i]));
      write_tiff(folder + names[k], levels, {});
      files[k].push_back(folder + names[k]);
      if (seed == 1) first[k] = read_image(folder + names[k]);
    }
  }
  CorrelationSettings settings;
  settings.window_px = {32};
  auto const median_u = [&](StoredFrames const& frames) {
    DisplacementField const field = make_correlator(settings)->correlate_pair(frames);
    std::vector<double> u;
    for (Vec2d const& d : field.displacement_px) u.push_back(d.x);
    std::nth_element(u.begin(), u.begin() + static_cast<std::ptrdiff_t>(u.size() / 2), u.end());
    return u[u.size() / 2];
  };
  EXPECT_NEAR(median_u(HostFrames(first[0], first[1])), 0.0, 0.1);
  for (char const* subtract : {"minimum", "mean", "median"}) {
    HostFrames const frames = with_step(first[0], first[1], make_background_subtraction(subtract, files[0], files[1]));
    EXPECT_NEAR(median_u(frames), 2.0, 0.05) << subtract;
  }
  for (int seed = 1; seed <= 6; ++seed)
    for (char const* frame : {"a", "b"})
      std::filesystem::remove(folder + "gladstone_" + frame + std::to_string(seed) + ".tif");
}

// Windows of which at least half is masked have no vector; the others have the vectors of the unmasked frames.
TEST(Mask, LeavesTheOtherVectorsAsTheyAre) {
  ParticlePair const pair = render_particle_pair({}, [](Vec2d) { return Vec2d{1.3, -0.4}; });
  CorrelationSettings settings;
  settings.window_px = {32};
  settings.weighting = "uniform";
  DisplacementField const all = make_correlator(settings)->correlate(pair.reference, pair.flow);
  DisplacementField const some = make_correlator(settings)->correlate_pair(
      with_mask(pair.reference, pair.flow, make_polygon_mask({{-1, -1}, {99.5, -1}, {99.5, 300}, {-1, 300}})));
  for (std::size_t i = 0; i < all.size(); ++i) {
    double const left = all.position_px[i].x - 15.5, share = std::clamp((100.0 - left) / 32.0, 0.0, 1.0);
    EXPECT_EQ(some.status[i] == VectorStatus::masked, share > 0.5) << left;
    // float sums relative to another level
    if (share == 0.0) {
      EXPECT_LT(length(some.raw_px[i] - all.raw_px[i]), 1e-4);
    }
  }
}

}  // namespace
}  // namespace gladstone
