#include "analysis/preparation/illumination.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "render/base/median.h"

namespace gladstone::inline preparation {
namespace {

constexpr int blocks_across = 8;  // number of blocks along the image's shorter side
constexpr int least_block = 16;   // minimum side of a block [px]

/// Position of a pixel between the centres of two adjacent blocks, along one axis: the two blocks, and the
/// interpolation weight of the second. The weight is outside of [0, 1] near the image's edges, where values are
/// extrapolated.
struct BlockPlace {
  int first, second;
  double share;
};

BlockPlace between_centres(int at, int pixels, int blocks) {
  if (blocks == 1) return {0, 0, 0.0};
  double const place = (at + 0.5) * blocks / pixels - 0.5;
  int const first = std::clamp(static_cast<int>(place), 0, blocks - 2);
  return {first, first + 1, place - first};
}

/// Returns the median over a rectangle; `right` and `low` are one past its last column and row.
double block_median(Image<double> const& levels, int left, int right, int top, int low) {
  std::vector<double> values;
  for (int row = top; row < low; ++row) {
    for (int column = left; column < right; ++column) values.push_back(levels(column, row));
  }
  return upper_median(std::move(values));
}

}  // namespace

Image<double> estimate_background(Image<double> const& levels) {
  int const columns = levels.columns(), rows = levels.rows();
  int const side = std::max(least_block, std::min(columns, rows) / blocks_across);
  int const across = std::max(1, columns / side), down = std::max(1, rows / side);
  Image<double> medians(across, down);
  for (int row = 0; row < down; ++row) {
    for (int column = 0; column < across; ++column) {
      medians(column, row) = block_median(levels, column * columns / across, (column + 1) * columns / across,
                                          row * rows / down, (row + 1) * rows / down);
    }
  }
  Image<double> background(columns, rows);
  for (int row = 0; row < rows; ++row) {
    BlockPlace const v = between_centres(row, rows, down);
    for (int column = 0; column < columns; ++column) {
      BlockPlace const u = between_centres(column, columns, across);
      double const upper = medians(u.first, v.first) * (1 - u.share) + medians(u.second, v.first) * u.share;
      double const lower = medians(u.first, v.second) * (1 - u.share) + medians(u.second, v.second) * u.share;
      background(column, row) = upper * (1 - v.share) + lower * v.share;
    }
  }
  return background;
}

}  // namespace gladstone::inline preparation
