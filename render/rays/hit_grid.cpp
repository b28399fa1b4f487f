#include "render/rays/hit_grid.h"

#include <algorithm>
#include <cmath>

namespace gladstone {
namespace {

constexpr double nodes_a_sigma = 3;
constexpr int most_nodes_a_pixel = 24;
constexpr std::uint64_t fewest_rays = 192;  // beyond which blurring the grid takes less time than their spots

/// Nodes that the cubic B-spline weights of a place deal to, and these.
struct Dealt {
  int first;
  double weight[4];
};

Dealt deal(double u) {
  double const whole = std::floor(u), t = u - whole, s = 1 - t;
  return {static_cast<int>(whole) - 1,
          {s * s * s / 6, (4 - 6 * t * t + 3 * t * t * t) / 6, (4 - 6 * s * s + 3 * s * s * s) / 6, t * t * t / 6}};
}

}  // namespace

bool HitGrid::pays(double sigma, std::uint64_t rays) {
  return rays >= fewest_rays && sigma * most_nodes_a_pixel >= nodes_a_sigma;
}

HitGrid::HitGrid(GaussianSpot<double> const& spot)
    : per_px_(std::max(2, static_cast<int>(std::ceil(nodes_a_sigma / spot.sigma)))),
      reach_(spot.half_width() + 1),
      side_(side_px * per_px_) {
  // coefficients of the spline through what a pixel sees of hits at the nodes, (c[-1] + 4 c[0] + c[1]) / 6 = s[0]
  int const reach = (reach_ + 2) * per_px_, count = 2 * reach + 1;
  std::vector<double> c(static_cast<std::size_t>(count)), upper(c.size());
  for (int i = 0; i < count; ++i) {
    double const x = static_cast<double>(i - reach) / per_px_;
    auto const at = static_cast<std::size_t>(i);
    c[at] = 6 * (GaussianSpot<double>::edge_value((x + 0.5) / spot.sigma) -
                 GaussianSpot<double>::edge_value((x - 0.5) / spot.sigma));
    double const before = i > 0 ? upper[at - 1] : 0, c_before = i > 0 ? c[at - 1] : 0;
    upper[at] = 1 / (4 - before);
    c[at] = (c[at] - c_before) * upper[at];
  }
  for (int i = count - 2; i >= 0; --i) {
    c[static_cast<std::size_t>(i)] -= upper[static_cast<std::size_t>(i)] * c[static_cast<std::size_t>(i + 1)];
  }
  int const width = 2 * reach_ + 2;
  share_.resize(static_cast<std::size_t>(per_px_ * width));
  for (int phase = 0; phase < per_px_; ++phase) {
    for (int j = 0; j < width; ++j) {
      int const offset = phase - (j - reach_) * per_px_;  // of the node from the pixel
      share_[static_cast<std::size_t>(phase * width + j)] =
          std::abs(offset) <= reach ? c[static_cast<std::size_t>(offset + reach)] : 0;
    }
  }
  light_.resize(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_));
}

void HitGrid::deposit(Vec2d p, double weight, LightImage* image, double light_per_weight) {
  if (!(std::abs(p.x) < 1e8 && std::abs(p.y) < 1e8)) return;
  bool const untouched = high_column_ == low_column_;
  Dealt x = deal((p.x - left_) * per_px_), y = deal((p.y - top_) * per_px_);
  if (untouched || x.first < 0 || y.first < 0 || x.first + 4 > side_ || y.first + 4 > side_) {
    if (!untouched) flush(image, light_per_weight);
    left_ = static_cast<int>(std::floor(p.x)) - side_px / 2;
    top_ = static_cast<int>(std::floor(p.y)) - side_px / 2;
    low_column_ = low_row_ = side_;
    high_column_ = high_row_ = 0;
    x = deal((p.x - left_) * per_px_);
    y = deal((p.y - top_) * per_px_);
  }
  low_column_ = std::min(low_column_, x.first);
  high_column_ = std::max(high_column_, x.first + 4);
  low_row_ = std::min(low_row_, y.first);
  high_row_ = std::max(high_row_, y.first + 4);
  double* line = light_.data() + y.first * side_ + x.first;
  for (int j = 0; j < 4; ++j, line += side_) {
    double const share = weight * y.weight[j];
    for (int i = 0; i < 4; ++i) line[i] += share * x.weight[i];
  }
}

void HitGrid::flush(LightImage* image, double light_per_weight) {
  if (high_column_ == low_column_) return;
  int const width = 2 * reach_ + 2;
  int const first_column = low_column_ / per_px_ - reach_, first_row = low_row_ / per_px_ - reach_;
  int const columns = (high_column_ - 1) / per_px_ - reach_ + width - first_column;
  int const rows = (high_row_ - 1) / per_px_ - reach_ + width - first_row;
  picture_.assign(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0.0);
  for (int node_row = low_row_; node_row < high_row_; ++node_row) {
    // along the row first
    row_.assign(static_cast<std::size_t>(columns), 0.0);
    double* const line = light_.data() + node_row * side_;
    for (int node = low_column_; node < high_column_; ++node) {
      double const light = line[node];
      if (light == 0) continue;
      line[node] = 0;
      double* const out = row_.data() + (node / per_px_ - reach_ - first_column);
      double const* const share = share_.data() + node % per_px_ * width;
      for (int j = 0; j < width; ++j) out[j] += light * share[j];
    }
    double const* const share = share_.data() + node_row % per_px_ * width;
    double* out = picture_.data() + (node_row / per_px_ - reach_ - first_row) * columns;
    for (int j = 0; j < width; ++j, out += columns) {
      for (int i = 0; i < columns; ++i) out[i] += share[j] * row_[static_cast<std::size_t>(i)];
    }
  }
  for (int row = 0; image && row < rows; ++row) {
    for (int column = 0; column < columns; ++column) {
      double const light = picture_[static_cast<std::size_t>(row * columns + column)];
      if (light != 0) image->add(left_ + first_column + column, top_ + first_row + row, light * light_per_weight);
    }
  }
  low_column_ = high_column_ = low_row_ = high_row_ = 0;
}

}  // namespace gladstone
