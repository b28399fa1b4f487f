#pragma once

#include <functional>
#include <vector>

#include "render/base/image.h"
#include "render/base/vec.h"

namespace gladstone::inline compare {

/// Values at nodes of a map, and their standard errors.
struct MapSamples {
  std::vector<Vec2d> value;
  std::vector<Vec2d> error;  ///< standard errors; empty: all are negligible; NaN: the error is unknown
};

/// Node of a map.
struct MapNode {
  int column = 0, row = 0;
};

/// Computes the values at nodes, some of which may be beyond the last column or row.
using MapSampler = std::function<MapSamples(std::vector<MapNode> const& nodes)>;

/// Deviation of an interpolated value, in excess of four standard errors, above which the surrounding nodes are
/// computed.
inline constexpr double refinement_tolerance = 5e-4;

/// Computes a map from few nodes. All nodes of a lattice of spacing `coarsest` / 2 are computed, and compared with
/// their cubic interpolation (Lagrange, of 4 x 4 nodes) from the lattice of twice the spacing. Where both agree to
/// within the tolerance, nodes in between are interpolated; elsewhere they are computed, and compared likewise. Cubic
/// interpolation over half the distance is 16 times more accurate where the map is smooth, so that the errors of
/// interpolated nodes are well below the tolerance. Details between nodes are missed if they change the value
/// of no node.
/// @param coarsest  a power of 2; 1: all nodes are computed
/// @return the map; NaN where the sampler returns NaN
Image<Vec2d> refine_map(int columns, int rows, int coarsest, MapSampler const& sample);

}  // namespace gladstone::inline compare
