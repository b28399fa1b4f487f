#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "analysis/density/gradient_map.h"

namespace gladstone::inline density {

/// Connected set of valid nodes, in which neighbours along x or y are connected. A gradient determines the density of a
/// region up to one constant.
struct Region {
  std::size_t nodes = 0;                                               ///< number of nodes
  std::size_t reference_nodes = 0;                                     ///< number of nodes with given density
  int first_column = 0, last_column = 0, first_row = 0, last_row = 0;  ///< bounding box
};

/// Regions of a map, in descending order of size, and the region of every node.
struct RegionMap {
  std::vector<Region> regions;
  std::vector<int> label;  ///< index of the node's region [grid.size()]; -1: invalid node
};

/// Divides the valid nodes into connected regions (4-neighbourhood).
RegionMap find_regions(GradientMap const& map);

/// Returns a description such as "820 nodes in columns 0-40, rows 3-22" for messages.
std::string describe_region(Region const& region);

}  // namespace gladstone::inline density
