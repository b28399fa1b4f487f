#include "analysis/tracking/dot_groups.h"

#include <algorithm>
#include <numeric>
#include <utility>

#include "render/base/point_cells.h"

namespace gladstone::inline tracking {
namespace {

/// Returns the connected components of dots closer than a distance, in the order of their first dots.
std::vector<std::vector<std::size_t>> link_dots(std::span<Vec2d const> centres, std::vector<std::size_t> const& members,
                                                double distance) {
  std::vector<Vec2d> points;
  for (std::size_t const i : members) points.push_back(centres[i]);
  PointCells const cells(points, distance);
  std::vector<std::vector<std::size_t>> groups;
  std::vector<bool> seen(points.size());
  for (std::size_t first = 0; first < points.size(); ++first) {
    if (seen[first]) continue;
    std::vector<std::size_t> group{first};
    seen[first] = true;
    for (std::size_t next = 0; next < group.size(); ++next) {
      Vec2d const here = points[group[next]];
      cells.for_near(here, distance, [&](std::size_t k) {
        if (seen[k] || !(length(points[k] - here) < distance)) return;
        seen[k] = true;
        group.push_back(k);
      });
    }
    std::sort(group.begin(), group.end());
    for (std::size_t& k : group) k = members[k];
    groups.push_back(std::move(group));
  }
  return groups;
}

}  // namespace

std::vector<std::vector<std::size_t>> group_dots(std::span<Vec2d const> centres, double distance_px) {
  std::vector<std::size_t> all(centres.size());
  std::iota(all.begin(), all.end(), std::size_t{0});
  std::vector<std::vector<std::size_t>> done;
  std::vector<std::pair<std::vector<std::size_t>, double>> open{{std::move(all), distance_px}};
  while (!open.empty()) {
    auto const [members, distance] = std::move(open.back());
    open.pop_back();
    for (std::vector<std::size_t>& group : link_dots(centres, members, distance)) {
      if (group.size() <= largest_group || distance < 0.1 * distance_px)
        done.push_back(std::move(group));
      else
        open.emplace_back(std::move(group), 0.85 * distance);
    }
  }
  std::sort(done.begin(), done.end());
  return done;
}

}  // namespace gladstone::inline tracking
