#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "render/base/contracts.h"
#include "render/base/vec.h"

namespace gladstone::inline base {

/// Points of the plane sorted into square cells, for neighbour searches in constant time. Points that are not finite
/// are excluded. The order in which neighbours are visited depends only on the points.
class PointCells {
 public:
  /// @param points  [px]
  /// @param cell    edge of a cell, ideally about the radius of the queries [px]
  /// @pre fewer than 2^32 points; cell > 0
  PointCells(std::span<Vec2d const> points, double cell) : cell_(cell) {
    GLADSTONE_EXPECTS(cell > 0.0 && points.size() < (std::size_t{1} << 32));
    Vec2d high{};
    bool any = false;
    for (Vec2d const& p : points) {
      if (!is_finite(p)) continue;
      low_ = any ? Vec2d{std::min(low_.x, p.x), std::min(low_.y, p.y)} : p;
      high = any ? Vec2d{std::max(high.x, p.x), std::max(high.y, p.y)} : p;
      any = true;
    }
    if (!any) return;
    // Limit the number of cells, since a few distant points could demand more cells than there are points.
    double const most = 4.0 * static_cast<double>(points.size()) + 16.0;
    constexpr double farthest = 1e150;  // limits width and height, so that their product is finite
    double const width = std::min(high.x - low_.x, farthest), height = std::min(high.y - low_.y, farthest);
    double const wanted = (width / cell_ + 1.0) * (height / cell_ + 1.0);
    if (wanted > most) cell_ = std::max(cell_ * std::sqrt(wanted / most), std::max(width, height) / most);
    columns_ = static_cast<int>(width / cell_) + 1;
    rows_ = static_cast<int>(height / cell_) + 1;

    // Counting sort by cell keeps the points of a cell in their order.
    first_.assign(static_cast<std::size_t>(columns_) * rows_ + 1, 0);
    for (Vec2d const& p : points) {
      if (is_finite(p)) ++first_[index_of(p) + 1];
    }
    for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
    sorted_.resize(first_.back());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (is_finite(points[i])) sorted_[next[index_of(points[i])]++] = static_cast<std::uint32_t>(i);
    }
  }

  /// Calls visit(index) for every point in the square |x - c.x|, |y - c.y| <= radius and for some points outside of it.
  /// Does nothing if c is not finite.
  template <class Visit>
  void for_near(Vec2d c, double radius, Visit&& visit) const {
    if (columns_ == 0 || !is_finite(c)) return;
    int const left = clamped((c.x - radius - low_.x) / cell_, columns_);
    int const right = clamped((c.x + radius - low_.x) / cell_, columns_);
    int const top = clamped((c.y - radius - low_.y) / cell_, rows_);
    int const bottom = clamped((c.y + radius - low_.y) / cell_, rows_);
    for (int row = top; row <= bottom; ++row) {
      std::size_t const begin = static_cast<std::size_t>(row) * columns_;
      for (std::uint32_t i = first_[begin + left]; i < first_[begin + right + 1]; ++i) visit(sorted_[i]);
    }
  }

 private:
  static int clamped(double cell, int count) {
    return static_cast<int>(std::clamp(std::floor(cell), 0.0, static_cast<double>(count - 1)));
  }
  std::size_t index_of(Vec2d p) const {
    int const column = clamped((p.x - low_.x) / cell_, columns_);
    int const row = clamped((p.y - low_.y) / cell_, rows_);
    return static_cast<std::size_t>(row) * columns_ + static_cast<std::size_t>(column);
  }

  double cell_;
  Vec2d low_{};
  int columns_ = 0;
  int rows_ = 0;
  std::vector<std::uint32_t> first_;   // index of the first sorted point of each cell, and end index
  std::vector<std::uint32_t> sorted_;  // point indices
};

}  // namespace gladstone::inline base
