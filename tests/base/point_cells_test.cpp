#include "render/base/point_cells.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <vector>

namespace gladstone {
namespace {

std::vector<std::size_t> near(PointCells const& cells, Vec2d c, double radius) {
  std::vector<std::size_t> found;
  cells.for_near(c, radius, [&found](std::size_t i) { found.push_back(i); });
  std::sort(found.begin(), found.end());
  return found;
}

// For any distances between the points, the number of cells is at most a few times that of the points, and all points
// in the query range are found.
TEST(PointCells, FindPointsNearbyDespiteDistantOnes) {
  double const nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  std::vector<Vec2d> const points{{1, 1}, {2, 2}, {1e308, 0}, {-1e308, -1e308}, {nan, 0}, {0, infinity}, {1e15, 3}};
  PointCells const cells(points, 8.0);
  auto const found = near(cells, {1.5, 1.5}, 4.0);
  EXPECT_TRUE(std::find(found.begin(), found.end(), 0u) != found.end());
  EXPECT_TRUE(std::find(found.begin(), found.end(), 1u) != found.end());
  for (std::size_t const none : {4u, 5u}) EXPECT_TRUE(std::find(found.begin(), found.end(), none) == found.end());
}

TEST(PointCells, FindNothingAtPlacesThatAreNotFinite) {
  PointCells const cells(std::vector<Vec2d>{{1, 1}, {2, 2}}, 8.0);
  double const nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  EXPECT_TRUE(near(cells, {nan, 1}, 4.0).empty());
  EXPECT_TRUE(near(cells, {1, -infinity}, 4.0).empty());
}

}  // namespace
}  // namespace gladstone
