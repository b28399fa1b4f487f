#include "render/light/dot_pattern.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>

#include "render/base/error.h"
#include "render/files/image_file.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

using testing::HasSubstr;

std::string temporary(std::string const& name) {
  return (std::filesystem::path(testing::TempDir()) / ("dots_" + name)).string();
}

std::string write_text(std::string const& name, std::string const& text) {
  std::string const path = temporary(name);
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

// 2000 discs cover 45 % of the area, near the limit of random placement. Every pair is checked for overlap.
TEST(RandomDots, NeverOverlapAndAreAllThere) {
  Vec2d const extent{0.10, 0.05};
  double const diameter = std::sqrt(0.45 * extent.x * extent.y / (2000 * 0.785398));
  auto const dots = random_dots(extent, 2000, diameter, 7);
  ASSERT_EQ(dots.size(), 2000u);
  for (std::size_t i = 0; i < dots.size(); ++i) {
    EXPECT_LE(std::abs(dots[i].x), extent.x / 2);
    EXPECT_LE(std::abs(dots[i].y), extent.y / 2);
    for (std::size_t j = 0; j < i; ++j) ASSERT_GE(length(dots[i] - dots[j]), diameter) << i << " " << j;
  }
}

// Chi-square statistic of the counts in 100 equal cells. For points, it is 99 +- sqrt(198); the tolerance is five
// standard deviations. Discs without overlap are more even than points, never less.
TEST(RandomDots, AreUniform) {
  for (double const diameter : {0.0, 0.004}) {
    auto const dots = random_dots({1, 1}, 20000, diameter, 3);
    std::vector<double> counts(100, 0.0);
    for (Vec2d const p : dots)
      ++counts[static_cast<std::size_t>((p.x + 0.5) * 10) * 10 + static_cast<std::size_t>((p.y + 0.5) * 10)];
    double chi2 = 0;
    for (double const count : counts) chi2 += (count - 200) * (count - 200) / 200;
    EXPECT_LT(chi2, 99 + 5 * std::sqrt(198.0)) << diameter;
    if (diameter == 0) {
      EXPECT_GT(chi2, 99 - 5 * std::sqrt(198.0));
    }
  }
}

// The density of Table 1: 20 dots of 3 px in 32 x 32 px, 14 % of the area.
TEST(RandomDots, AMillionTakeSeconds) {
  double const side = std::sqrt(1e6 * 1024 / 20);
  std::clock_t const start = std::clock();
  auto const dots = random_dots({side, side}, 1000000, 3.0, 7);
  EXPECT_EQ(dots.size(), 1000000u);
  EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 10.0);
}

// The memory is proportional to the number of dots, not to the ratio of target size to dot size.
TEST(RandomDots, MayBeTinyOnALargeTarget) { EXPECT_EQ(random_dots({1.0, 1.0}, 1000, 1e-9, 7).size(), 1000u); }

TEST(RandomDots, RepeatBySeed) {
  auto const once = random_dots({1, 1}, 500, 0.01, 7);
  EXPECT_EQ(once, random_dots({1, 1}, 500, 0.01, 7));
  EXPECT_NE(once, random_dots({1, 1}, 500, 0.01, 8));
}

TEST(RandomDots, TooManyAreRefused) {
  // 1000 discs of 4 cm on one square metre: 126 % of the area
  EXPECT_THAT(
      [] {
        random_dots({1, 1}, 1000, 0.04, 7);
      },
      ThrowsDataError(ErrorCode::invalid_value, "target", HasSubstr("126 %")));
}

// 0.25 dots per square millimetre form a lattice of 2 mm; 7 x 5 mm contain three by two dots, centred on the axis.
TEST(RegularDots, LieOnACentredSquareLattice) {
  auto const dots = regular_dots({7e-3, 5e-3}, 0.25e6, 1e-3);
  ASSERT_EQ(dots.size(), 6u);
  for (int row = 0; row < 2; ++row) {
    for (int column = 0; column < 3; ++column) {
      Vec2d const dot = dots[static_cast<std::size_t>(3 * row + column)];
      EXPECT_NEAR(dot.x, (column - 1) * 2e-3, 1e-15);
      EXPECT_NEAR(dot.y, (row - 0.5) * 2e-3, 1e-15);
    }
  }
}

TEST(RegularDots, ThatTouchAreRefused) {
  EXPECT_THAT([] { regular_dots({1, 1}, 100, 0.11); }, ThrowsDataError(ErrorCode::invalid_value, "target"));
}

TEST(DotsFromCsv, AreReadInMillimetres) {
  auto const dots = dots_from_csv(write_text("good.csv", "x_mm,y_mm\r\n1.5,-2\r\n\n-0.25,3e1\n"), 1.0);
  ASSERT_EQ(dots.size(), 2u);
  EXPECT_DOUBLE_EQ(dots[0].x, 1.5e-3);
  EXPECT_DOUBLE_EQ(dots[0].y, -2e-3);
  EXPECT_DOUBLE_EQ(dots[1].x, -0.25e-3);
  EXPECT_DOUBLE_EQ(dots[1].y, 30e-3);
}

TEST(DotsFromCsv, MistakesAreReportedWithFileAndLine) {
  auto const refused = [](std::string const& text, std::string const& where, ErrorCode code) {
    std::string const path = write_text("bad.csv", text);
    EXPECT_THAT([&] { dots_from_csv(path, 1.0); }, ThrowsDataError(code, path + where)) << text;
  };
  refused("x,y\n1,2\n", ":1", ErrorCode::wrong_format);
  refused("", ":1", ErrorCode::wrong_format);
  refused("x_mm,y_mm\n1,2\n3\n", ":3", ErrorCode::syntax);
  refused("x_mm,y_mm\n1,two\n", ":2", ErrorCode::syntax);
  refused("x_mm,y_mm\n1,2,3\n", ":2", ErrorCode::syntax);
  refused("x_mm,y_mm\nnan,2\n", ":2", ErrorCode::syntax);
  refused("x_mm,y_mm\n1,1e999\n", ":2", ErrorCode::syntax);
  refused("x_mm,y_mm\n", "", ErrorCode::missing_content);
  refused("x_mm,y_mm\n1,2\n1e9,0\n", ":3", ErrorCode::out_of_range);
  refused("x_mm,y_mm\n1,2\n0,-1000.1\n", ":3", ErrorCode::out_of_range);
  EXPECT_THAT([] { dots_from_csv(temporary("absent.csv"), 1.0); },
              ThrowsDataError(ErrorCode::missing_file, "absent.csv"));
}

// Two dots at one position are a single dot to a camera. The message names the first pair in the file and the number of
// all; dots a nanometre apart are distinct.
TEST(DotsFromCsv, CoincidentDotsAreRefused) {
  auto const read = [](std::string const& text) { return dots_from_csv(write_text("twice.csv", text), 1.0); };
  EXPECT_THAT([&] { read("x_mm,y_mm\n5,6\n1,2\n\n3,4\n1.0,2e0\n3.0000000001,4\n1,2\n"); },
              ThrowsDataError(ErrorCode::invalid_value, "twice.csv:6", HasSubstr("3 of 6 dots")));
  EXPECT_EQ(read("x_mm,y_mm\n1,2\n1.000002,2\n2,1\n1,2.000002\n").size(), 4u);
}

// Four by two pixels over 8 x 4 mm are squares of 2 mm. The first row is at the top, the radiance is the grey value
// relative to the largest one, and black pixels emit no light.
TEST(PictureTarget, PixelsAreSquaresOfTheirGrey) {
  Image<std::uint16_t> picture(4, 2, 0);
  picture(0, 0) = 1000;
  picture(3, 1) = 4000;
  std::string const path = temporary("picture.tif");
  write_tiff(path, picture, {16, 10e-6, ""});
  DotPattern const target = image_target(path, {8e-3, 4e-3});
  ASSERT_EQ(target.centre.size(), 2u);
  EXPECT_EQ(target.shape, SourceShape::square);
  EXPECT_NEAR(target.half_size, 1e-3, 1e-15);
  EXPECT_NEAR(target.centre[0].x, -3e-3, 1e-15);
  EXPECT_NEAR(target.centre[0].y, 1e-3, 1e-15);
  EXPECT_NEAR(target.centre[1].x, 3e-3, 1e-15);
  EXPECT_NEAR(target.centre[1].y, -1e-3, 1e-15);
  EXPECT_DOUBLE_EQ(target.radiance[0], 0.25);
  EXPECT_DOUBLE_EQ(target.radiance[1], 1.0);

  EXPECT_THAT([&] { image_target(path, {8e-3, 8e-3}); }, ThrowsDataError(ErrorCode::inconsistent, path));
  write_tiff(path, Image<std::uint16_t>(4, 2, 0), {16, 10e-6, ""});
  EXPECT_THAT([&] { image_target(path, {8e-3, 4e-3}); }, ThrowsDataError(ErrorCode::invalid_value, path));
}

}  // namespace
}  // namespace gladstone
