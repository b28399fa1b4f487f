#include "studies/case/preparation_setup.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "render/base/error.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

using ::testing::HasSubstr;

FramePreparation preparation_of(std::string const& tables, PreparedSet set = PreparedSet::pair) {
  SetupDocument document = SetupDocument::from_text(tables, "case.toml", "/frames");
  SetupTable correlate = document.root().table("correlate");
  FramePreparation preparation = read_frame_preparation(correlate, set);
  document.finish();
  return preparation;
}

std::string problems_of(std::string const& tables) {
  return error_of([&] { preparation_of(tables); });
}

TEST(FramePreparation, ReadsMasksAndStepsInTheirOrder) {
  FramePreparation const read = preparation_of(
      "[[correlate.mask]]\nkind = \"image\"\nfile = \"mask.tif\"\n"
      "[[correlate.mask]]\nkind = \"intensity\"\nabove_dn = 1\n"
      "[[correlate.preprocess]]\nkind = \"high_pass\"\n"
      "[[correlate.preprocess]]\nkind = \"intensity_cap\"\n"
      "[[correlate.preprocess]]\nkind = \"clahe\"\n");
  EXPECT_EQ(read.masks.size(), 2u);
  EXPECT_EQ(read.steps.size(), 3u);
  EXPECT_THAT(read.files, ::testing::ElementsAre("/frames/mask.tif"));
}

// Values of the setup reach the step: a cap at the median (0) plus 3 standard deviations of one bright pixel of n,
// h sqrt(n - 1)/n, and not at the default of 2.
TEST(FramePreparation, PassesOnTheValuesOfTheSetup) {
  Image<double> frame(20, 20, 0.0);
  frame(5, 6) = 1000.0;
  HostFrames const capped = prepare_frames(
      HostFrames(frame, frame), preparation_of("[[correlate.preprocess]]\nkind = \"intensity_cap\"\ndeviations = 3\n"));
  EXPECT_NEAR(capped.flow()(5, 6), 3.0 * 1000.0 * std::sqrt(399.0) / 400.0, 1e-9);
  HostFrames const masked = prepare_frames(
      HostFrames(frame, frame), preparation_of("[[correlate.mask]]\nkind = \"polygon\"\n"
                                               "x_px = [3.5, 6.5, 6.5, 3.5]\ny_px = [4.5, 4.5, 9.5, 9.5]\n"));
  for (int j = 0; j < 20; ++j)
    for (int i = 0; i < 20; ++i)
      EXPECT_EQ(std::isnan(masked.flow()(i, j)), i >= 4 && i < 7 && j >= 5 && j < 10) << i << ' ' << j;
}

// Only the preparation of a sequence may omit the frames of a background.
TEST(FramePreparation, OfASequenceHasABackgroundWithoutFrames) {
  std::string const text = "[[correlate.preprocess]]\nkind = \"background\"\nsubtract = \"median\"\n";
  EXPECT_THROW(preparation_of(text), SetupError);
  FramePreparation const preparation = preparation_of(text, PreparedSet::sequence);
  ASSERT_EQ(preparation.backgrounds.size(), 1u);
  EXPECT_EQ(preparation.backgrounds.front()->statistic, "median");
  preparation.backgrounds.front()->reference = Image<double>(4, 4, 2.0);
  preparation.backgrounds.front()->flow = Image<double>(4, 4, 3.0);
  HostFrames const prepared =
      prepare_frames(HostFrames(Image<double>(4, 4, 9.0), Image<double>(4, 4, 7.0)), preparation);
  EXPECT_EQ(prepared.reference()(1, 2), 7.0);
  EXPECT_EQ(prepared.flow()(1, 2), 4.0);
}

TEST(FramePreparation, SaysWhereItsSettingsAreWrong) {
  EXPECT_EQ(problems_of("[[correlate.mask]]\nkind = \"polygon\"\nx_px = [0, 1, 2]\ny_px = [0, 1, 2, 3]\n"),
            "invalid_value at case.toml:4:1");
  EXPECT_EQ(problems_of("[[correlate.mask]]\nkind = \"polygn\"\n"), "unknown_choice at case.toml:2:1");
  EXPECT_EQ(problems_of("[[correlate.mask]]\nx_px = [0, 1, 2]\ny_px = [0, 1, 2]\n"), "missing_key at case.toml:1:1");
  EXPECT_EQ(problems_of("[[correlate.mask]]\nkind = \"intensity\"\n"), "invalid_value at case.toml:2:1");
  EXPECT_EQ(problems_of("[[correlate.mask]]\nkind = \"image\"\n"), "missing_key at case.toml:1:1");
  EXPECT_EQ(problems_of("[[correlate.preprocess]]\nkind = \"background\"\n"), "missing_key at case.toml:1:1");
  EXPECT_EQ(problems_of("[[correlate.preprocess]]\nkind = \"high_pass\"\nsigma_px = 0\n"),
            "out_of_range at case.toml:3:1");
}

// The settings stored in vectors.h5 are a text with all defaults, which must be read back to the same settings.
TEST(FramePreparation, ReadsBackWhatItUnderstood) {
  auto const resolved = [](std::string const& text) {
    SetupDocument document = SetupDocument::from_text(text, "case.toml", "/frames");
    SetupTable correlate = document.root().table("correlate");
    EXPECT_EQ(read_frame_preparation(correlate).files.size(), 5u);
    document.finish();
    return document.resolved();
  };
  std::string const once = resolved(
      "[[correlate.mask]]\nkind = \"polygon\"\nx_px = [1, 2, 3]\ny_px = [1, 5, 1]\n"
      "[[correlate.mask]]\nkind = \"image\"\nfile = \"mask.tif\"\n"
      "[[correlate.preprocess]]\nkind = \"background\"\n"
      "frame = [{ reference = \"a.tif\", flow = \"b.tif\" }, { reference = \"c.tif\", flow = \"d.tif\" }]\n"
      "[[correlate.preprocess]]\nkind = \"min_max\"\n");
  EXPECT_THAT(once, HasSubstr("/frames/d.tif"));
  EXPECT_EQ(resolved(once), once);
}

}  // namespace
}  // namespace gladstone
