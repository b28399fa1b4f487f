#include "analysis/calibration/grid_assignment.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

namespace gladstone {
namespace {

constexpr CalibrationGrid grid{6, 4, 2.5e-3, 0.8e-3};

/// A plane in an oblique view, rotated by 12 degrees: the perspective changes the spacing by a third across the image.
Vec2d seen(double i, double j) {
  double const c = std::cos(0.21), s = std::sin(0.21), x = 40 * (c * i + s * j), y = 40 * (s * i - c * j);
  double const depth = 1 + 0.0007 * x;
  return {300 + x / depth, 220 + y / depth};
}

ExpectedView expected() { return {seen(0, 0), seen(1, 0) - seen(0, 0), seen(0, 1) - seen(0, 0)}; }

/// The dots of some columns and rows, in random order.
std::vector<DetectedDot> dots_of(int left, int right, int low, int high) {
  std::vector<DetectedDot> dots;
  for (int i = left; i <= right; ++i) {
    for (int j = low; j <= high; ++j) dots.push_back({seen(i, j), 1, 6});
  }
  std::shuffle(dots.begin(), dots.end(), std::mt19937(1));
  return dots;
}

void expect_right(AssignedDots const& assigned) {
  for (GridDot const& dot : assigned.dots) {
    EXPECT_LT(length(dot.pixel - seen(dot.i, dot.j)), 1e-9) << dot.i << ' ' << dot.j;
  }
}

TEST(GridAssignment, FollowsThePerspective) {
  AssignedDots const assigned = assign_to_grid(dots_of(-6, 6, -4, 4), grid, expected());
  EXPECT_EQ(assigned.dots.size(), 13u * 9u);
  EXPECT_EQ(assigned.middle_by, CentreDotMethod::whole_grid);
  expect_right(assigned);
}

// If the whole grid is visible, the camera of the setup may be wrong by several spacings, and by 40 degrees.
TEST(GridAssignment, OfAWholeGridNeedsNoGoodGuess) {
  ExpectedView wrong = expected();
  wrong.middle_px += Vec2d{130, -90};
  double const c = std::cos(0.6), s = std::sin(0.6);
  for (Vec2d* step : {&wrong.along_x_px, &wrong.along_y_px}) {
    *step = 0.5 * Vec2d{c * step->x - s * step->y, s * step->x + c * step->y};
  }
  AssignedDots const assigned = assign_to_grid(dots_of(-6, 6, -4, 4), grid, wrong);
  EXPECT_EQ(assigned.dots.size(), 13u * 9u);
  expect_right(assigned);
}

// A part of the grid whose middle is far from that of the whole grid: only the expected view determines the indices,
// within half a spacing.
TEST(GridAssignment, OfAPartTakesTheExpectedMiddle) {
  ExpectedView rough = expected();
  rough.middle_px += Vec2d{15, 10};
  AssignedDots const assigned = assign_to_grid(dots_of(-1, 6, -4, 2), grid, rough);
  EXPECT_EQ(assigned.dots.size(), 8u * 7u);
  EXPECT_EQ(assigned.middle_by, CentreDotMethod::expected_view);
  expect_right(assigned);
}

// All columns and a part of the rows: the columns determine the middle along X, however wrong the expected view is.
TEST(GridAssignment, NeedsTheExpectedMiddleOnlyAlongTheAxisThatIsCut) {
  ExpectedView rough = expected();
  rough.middle_px = seen(1.6, 0.2);
  AssignedDots const assigned = assign_to_grid(dots_of(-6, 6, -4, 2), grid, rough);
  EXPECT_EQ(assigned.dots.size(), 13u * 7u);
  EXPECT_EQ(assigned.middle_by, CentreDotMethod::expected_view);
  EXPECT_NEAR(assigned.middle_offset, 0.2, 0.02);
  expect_right(assigned);
}

// A spot displaced from a dot's position by a fifth of a spacing, and one half as large again: neither is a dot of the
// grid.
TEST(GridAssignment, RemovesSpotsOfWrongPositionOrSize) {
  std::vector<DetectedDot> dots = dots_of(-6, 6, -4, 4);
  for (DetectedDot& dot : dots) {
    if (length(dot.centre_px - seen(-3, 2)) < 1) dot.centre_px = seen(-2.85, 2.13);
    if (length(dot.centre_px - seen(2, -1)) < 1) dot.diameter_px = 9;
  }
  AssignedDots const assigned = assign_to_grid(dots, grid, expected());
  EXPECT_EQ(assigned.dots.size(), 13u * 9u - 2);
  EXPECT_EQ(assigned.strangers.size(), 2u);
  EXPECT_EQ(assigned.middle_by, CentreDotMethod::whole_grid);
  expect_right(assigned);
}

// The scatter about a smooth grid is the noise, except for the part of the perspective that a cubic polynomial does not
// describe: the fourth term of x / (1 + u), 240 u^3 with u = 0.17 at the edge, over 8 for the best cubic, at most 0.15
// px.
TEST(GridAssignment, TellsTheScatterOfItsDots) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, 0.5);
  std::vector<DetectedDot> dots = dots_of(-6, 6, -4, 4);
  for (DetectedDot& dot : dots) dot.centre_px += Vec2d{noise(random), noise(random)};
  // 234 numbers less 20 terms determine the scatter to 1 / sqrt(2 * 214) = 5 %
  EXPECT_NEAR(assign_to_grid(dots, grid, expected()).smoothness_px, 0.5, 0.5 * 0.15 + 0.02);
}

TEST(GridAssignment, ToleratesMissingDotsAndOutliers) {
  std::vector<DetectedDot> dots = dots_of(-6, 6, -4, 4);
  std::erase_if(dots, [](DetectedDot const& dot) {
    return length(dot.centre_px - seen(0, 0)) < 1 || length(dot.centre_px - seen(-3, 2)) < 1;
  });
  dots.push_back({seen(2.5, 1.5), 1, 6});
  AssignedDots const assigned = assign_to_grid(dots, grid, expected());
  EXPECT_EQ(assigned.dots.size(), 13u * 9u - 2);
  expect_right(assigned);
}

TEST(GridAssignment, TooFewDotsAreNoGrid) {
  EXPECT_TRUE(assign_to_grid({}, grid, expected()).dots.empty());
  EXPECT_TRUE(assign_to_grid(dots_of(0, 1, 0, 0), grid, expected()).dots.empty());
}

}  // namespace
}  // namespace gladstone
