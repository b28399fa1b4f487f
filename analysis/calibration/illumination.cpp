#include "analysis/calibration/illumination.h"

#include <algorithm>
#include <vector>

namespace gladstone {
namespace {

constexpr int blocks_across = 8;  // the shorter side
constexpr int least_block = 16;   // [px]

/// Position among equal blocks: the cell between two centres and the share of the second, outside [0, 1] at the edges.
struct Between {
  int first, second;
  double share;
};

Between between_centres(int at, int pixels, int blocks) {
  if (blocks == 1) return {0, 0, 0.0};
  double const place = (at + 0.5) * blocks / pixels - 0.5;
  int const first = std::clamp(static_cast<int>(place), 0, blocks - 2);
  return {first, first + 1, place - first};
}

}  // namespace

double median_level(cv::Mat const& values) {
  std::vector<double> sorted(values.begin<double>(), values.end<double>());
  auto const middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
  std::nth_element(sorted.begin(), middle, sorted.end());
  return *middle;
}

cv::Mat estimate_background(cv::Mat const& levels) {
  int const side = std::max(least_block, std::min(levels.cols, levels.rows) / blocks_across);
  int const across = std::max(1, levels.cols / side), down = std::max(1, levels.rows / side);
  cv::Mat1d medians(down, across);
  for (int row = 0; row < down; ++row) {
    for (int column = 0; column < across; ++column) {
      int const left = column * levels.cols / across, right = (column + 1) * levels.cols / across;
      int const top = row * levels.rows / down, low = (row + 1) * levels.rows / down;
      medians(row, column) = median_level(levels(cv::Range(top, low), cv::Range(left, right)));
    }
  }
  cv::Mat1d background(levels.size());
  for (int row = 0; row < levels.rows; ++row) {
    Between const v = between_centres(row, levels.rows, down);
    for (int column = 0; column < levels.cols; ++column) {
      Between const u = between_centres(column, levels.cols, across);
      double const upper = medians(v.first, u.first) * (1 - u.share) + medians(v.first, u.second) * u.share;
      double const lower = medians(v.second, u.first) * (1 - u.share) + medians(v.second, u.second) * u.share;
      background(row, column) = upper * (1 - v.share) + lower * v.share;
    }
  }
  return background;
}

}  // namespace gladstone
