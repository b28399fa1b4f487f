#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>
#include <utility>
#include <vector>

#include "render/base/point_cells.h"

namespace gladstone::inline tracking {

/// Search for the nearest of a set of points. The points are not copied and must outlive the object.
class NearestPoints {
 public:
  explicit NearestPoints(std::span<Vec2d const> points)
      : points_(points), spacing_(mean_spacing(points)), cells_(points, 2 * spacing_) {}

  /// Returns the mean spacing: the square root of the mean area per point within the points' bounding box [px]; 1 if
  /// the box is empty.
  double spacing() const { return spacing_; }

  /// Returns the indices of up to `count` points nearest to c within a radius, nearest first; points at equal distances
  /// are sorted by their index.
  std::vector<std::size_t> nearest(Vec2d c, std::size_t count, double radius) const {
    double reach = std::min(radius, spacing_ * (1 + std::sqrt(0.5 * static_cast<double>(count))));
    while (true) {
      std::vector<std::size_t> found = within(c, reach);
      if (found.size() >= count || !(reach < radius)) {
        found.resize(std::min(found.size(), count));
        return found;
      }
      reach = std::min(radius, 2 * reach);
    }
  }

  /// Returns the indices of all points within a radius, nearest first.
  std::vector<std::size_t> within(Vec2d c, double radius) const {
    std::vector<std::pair<double, std::size_t>> found;
    cells_.for_near(c, radius, [&](std::size_t i) {
      Vec2d const apart = points_[i] - c;
      if (dot(apart, apart) <= radius * radius) found.emplace_back(dot(apart, apart), i);
    });
    std::sort(found.begin(), found.end());
    std::vector<std::size_t> indices;
    for (auto const& entry : found) indices.push_back(entry.second);
    return indices;
  }

  /// Returns the distance to the nearest point within a radius [px]; infinite if there is none.
  double distance(Vec2d c, double radius) const {
    double nearest2 = std::numeric_limits<double>::infinity();
    cells_.for_near(c, radius, [&](std::size_t i) {
      Vec2d const apart = points_[i] - c;
      nearest2 = std::min(nearest2, dot(apart, apart));
    });
    return nearest2 <= radius * radius ? std::sqrt(nearest2) : std::numeric_limits<double>::infinity();
  }

 private:
  static double mean_spacing(std::span<Vec2d const> points) {
    double const infinity = std::numeric_limits<double>::infinity();
    Vec2d low{infinity, infinity}, high{-infinity, -infinity};
    std::size_t count = 0;
    for (Vec2d const p : points) {
      if (!is_finite(p)) continue;
      low = {std::min(low.x, p.x), std::min(low.y, p.y)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y)};
      ++count;
    }
    double const area = count > 1 ? (high.x - low.x) * (high.y - low.y) : 0.0;
    return area > 0 && std::isfinite(area) ? std::sqrt(area / static_cast<double>(count)) : 1.0;
  }

  std::span<Vec2d const> points_;
  double spacing_;
  PointCells cells_;
};

}  // namespace gladstone::inline tracking
