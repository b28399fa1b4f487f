#pragma once

#include <algorithm>
#include <cmath>

#include "analysis/correlation/interrogation_grid.h"
#include "render/base/host_device.h"
#include "render/base/vec.h"

/// Interpolation of a displacement given at the nodes of a grid, by functions shared by the CPU and the CUDA kernels.
namespace gladstone::inline correlation {

/// Computes the weights of Keys' kernel (a = -1/2) for the nodes -1, 0, 1, 2, at a distance t from node 0 towards node
/// 1.
GLADSTONE_HD inline void cubic_convolution(double t, double* w) {
  w[0] = 0.5 * t * (-1.0 + t * (2.0 - t));
  w[1] = 1.0 + 0.5 * t * t * (-5.0 + 3.0 * t);
  w[2] = 0.5 * t * (1.0 + t * (4.0 - 3.0 * t));
  w[3] = 0.5 * t * t * (t - 1.0);
}

/// Returns the number of rows and columns of ghost nodes on each side of a grid that extend it beyond the image.
inline int ghost_nodes(InterrogationGrid const& grid, int image_columns, int image_rows) {
  double const beyond =
      std::max({grid.centre(GridAxis::x, 0), image_columns - grid.centre(GridAxis::x, grid.columns - 1),
                grid.centre(GridAxis::y, 0), image_rows - grid.centre(GridAxis::y, grid.rows - 1)});
  return static_cast<int>(std::ceil(beyond / grid.spacing_px)) + 2;
}

/// Returns value(k) for 0 <= k < count, and a linear extrapolation for other k. The slope of the extrapolation is
/// computed over half a window, because a shorter baseline would amplify noise.
template <class Value>
GLADSTONE_HD Vec2d extended(InterrogationGrid const& grid, int k, int count, Value const& value) {
  if (k >= 0 && k < count) return value(k);
  int const half_window = grid.window_px / (2 * grid.spacing_px);
  int const wanted = half_window > 1 ? half_window : 1;
  int const base = wanted < count - 1 ? wanted : count - 1;
  int const edge = k < 0 ? 0 : count - 1;
  if (base < 1) return value(edge);
  int const inner = k < 0 ? base : count - 1 - base;
  int const steps = k < 0 ? -k : k - edge;
  return value(edge) + (static_cast<double>(steps) / base) * (value(edge) - value(inner));
}

/// Returns the displacement at node (column, row) of a grid, extrapolated linearly outside the grid. @param node
/// node(k) returns the displacement at the k-th of grid.size() nodes
template <class Node>
GLADSTONE_HD Vec2d extended_node(InterrogationGrid const& grid, Node const& node, int column, int row) {
  return extended(grid, row, grid.rows, [&](int j) {
    return extended(grid, column, grid.columns, [&](int i) { return node(j * grid.columns + i); });
  });
}

/// Non-owning view of the displacement at the nodes of a grid and its ghost nodes.
struct PredictorView {
  /// Four nodes between which a position is interpolated along one axis, and their weights.
  struct Taps {
    int first;
    double weight[4];
  };

  InterrogationGrid grid;
  int ghosts;
  int columns;  ///< number of columns of nodes, including the ghost nodes, by which the grid is extended beyond the
                ///< image
  int rows;
  Vec2d const* nodes;

  GLADSTONE_HD Taps taps(GridAxis axis, double position_px) const {
    int const count = axis == GridAxis::x ? columns : rows;
    double const node = (position_px - grid.centre(axis, 0)) / grid.spacing_px + ghosts;
    double const last = static_cast<double>(count - 2);
    double const clamped = node < 1.0 ? 1.0 : (node > last ? last : node);
    int const whole = static_cast<int>(clamped);
    int const base = whole < count - 3 ? whole : count - 3;
    Taps result{base - 1, {}};
    cubic_convolution(clamped - base, result.weight);
    return result;
  }

  GLADSTONE_HD Vec2d at(Vec2d position_px) const {
    Taps const x = taps(GridAxis::x, position_px.x), y = taps(GridAxis::y, position_px.y);
    Vec2d sum;
    for (int j = 0; j < 4; ++j)
      for (int i = 0; i < 4; ++i)
        sum += (y.weight[j] * x.weight[i]) * nodes[static_cast<long long>(y.first + j) * columns + x.first + i];
    return sum;
  }
};

}  // namespace gladstone::inline correlation
