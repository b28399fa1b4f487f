#include "analysis/preparation/sequence_background.h"

#include <gtest/gtest.h>

#include <memory>

#include "analysis/preparation/frame_changes.h"
#include "render/base/error.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

// Pixel i of image k has the level (k + 1)(i + 1), in any order of the images; image 2 does not count.
TEST(Background, IsTheStatisticOfEachPixel) {
  std::vector<double> const factors{4, 1, 1000, 3, 8};
  auto const background = [&](std::string const& statistic, std::size_t count) {
    return compute_background(statistic, count, [&](std::size_t k) -> std::optional<Image<double>> {
      if (k == 2) return std::nullopt;
      Image<double> image(3, 2);
      for (std::size_t i = 0; i < image.size(); ++i) image.data()[i] = factors[k] * static_cast<double>(i + 1);
      return image;
    });
  };
  for (std::size_t i = 0; i < 6; ++i) {
    auto const unit = static_cast<double>(i + 1);
    EXPECT_EQ(background("minimum", 5).data()[i], 1 * unit);
    EXPECT_EQ(background("mean", 5).data()[i], 4 * unit);
    EXPECT_EQ(background("median", 5).data()[i], 3.5 * unit) << "mean of the middle two of 1 3 4 8";
    EXPECT_EQ(background("median", 4).data()[i], 3 * unit);
  }
  for (std::string const& statistic : background_statistics()) {
    auto const none = [](std::size_t) { return std::optional<Image<double>>(); };
    EXPECT_TRUE(compute_background(statistic, 3, none).empty()) << statistic;
  }
}

// A sequence computes its background after the preparation has been set up.
TEST(Background, OfASequenceIsComputedByTheSequence) {
  auto const background = std::make_shared<SequenceBackground>();
  FramePreparation preparation;
  preparation.steps.push_back(make_background_subtraction(background));
  HostFrames const frames(Image<double>(4, 4, 9.0), Image<double>(4, 4, 7.0));
  EXPECT_THAT([&] { prepare_frames(frames, preparation); },
              ThrowsDataError(ErrorCode::wrong_shape, "correlate.preprocess"))
      << "without its images";
  background->reference = Image<double>(4, 4, 2.0);
  background->flow = Image<double>(4, 4, 3.0);
  HostFrames const prepared = prepare_frames(frames, preparation);
  EXPECT_EQ(prepared.reference()(1, 2), 7.0);
  EXPECT_EQ(prepared.flow()(1, 2), 4.0);
}

}  // namespace
}  // namespace gladstone
