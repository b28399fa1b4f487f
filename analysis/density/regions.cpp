#include "analysis/density/regions.h"

#include <fmt/format.h>

#include <algorithm>
#include <numeric>
#include <utility>

namespace gladstone::inline density {
namespace {

/// Labels the region of one seed node and returns its extent.
Region fill_region(GradientMap const& map, int column, int row, int label, std::vector<int>& labels) {
  Region region{0, 0, column, column, row, row};
  std::vector<std::pair<int, int>> open{{column, row}};
  labels[map.grid.index(column, row)] = label;
  while (!open.empty()) {
    auto const [x, y] = open.back();
    open.pop_back();
    ++region.nodes;
    region.first_column = std::min(region.first_column, x);
    region.last_column = std::max(region.last_column, x);
    region.first_row = std::min(region.first_row, y);
    region.last_row = std::max(region.last_row, y);
    for (auto const& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      if (!map.is_valid(x + dx, y + dy)) continue;
      int& neighbour = labels[map.grid.index(x + dx, y + dy)];
      if (neighbour >= 0) continue;
      neighbour = label;
      open.emplace_back(x + dx, y + dy);
    }
  }
  return region;
}

}  // namespace

RegionMap find_regions(GradientMap const& map) {
  std::vector<Region> found;
  std::vector<int> labels(map.grid.size(), -1);
  for (int row = 0; row < map.grid.rows; ++row)
    for (int column = 0; column < map.grid.columns; ++column)
      if (map.is_valid(column, row) && labels[map.grid.index(column, row)] < 0)
        found.push_back(fill_region(map, column, row, static_cast<int>(found.size()), labels));

  // Sort by size and renumber the labels
  std::vector<std::size_t> order(found.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::stable_sort(order.begin(), order.end(),
                   [&](std::size_t a, std::size_t b) { return found[a].nodes > found[b].nodes; });
  RegionMap result;
  std::vector<int> rank(found.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    rank[order[i]] = static_cast<int>(i);
    result.regions.push_back(found[order[i]]);
  }
  result.label = std::move(labels);
  for (int& label : result.label)
    if (label >= 0) label = rank[static_cast<std::size_t>(label)];
  return result;
}

std::string describe_region(Region const& region) {
  return fmt::format("{} nodes in columns {}-{}, rows {}-{}", region.nodes, region.first_column, region.last_column,
                     region.first_row, region.last_row);
}

}  // namespace gladstone::inline density
