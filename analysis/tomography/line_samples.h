#pragma once

#include <cmath>
#include <cstddef>

#include "analysis/tomography/sight_line.h"
#include "render/base/host_device.h"
#include "render/base/regular_grid.h"
#include "render/base/vec.h"

namespace gladstone::inline tomography {

/// Grid of a volume, passed by value. The volume is the trilinear interpolant from the first to the last node of each
/// axis, and zero outside. The x index of the nodes varies fastest in memory.
struct VolumeShape {
  int nodes[3] = {2, 2, 2};
  Vec3d origin{};                        ///< position of node (0, 0, 0) [m]
  Vec3d inverse_spacing{1.0, 1.0, 1.0};  ///< reciprocal of the distance between nodes along each axis [1/m]
  double step = 1.0;                     ///< largest distance between samples of a line [m]

  /// @param steps_per_cell  number of samples per shortest edge of a cell
  static VolumeShape of(RegularGrid const& grid, double steps_per_cell = 2.0) {
    Vec3d const d = grid.spacing;
    double const shortest = std::fmin(d.x, std::fmin(d.y, d.z));
    return {{grid.nodes[0], grid.nodes[1], grid.nodes[2]},
            grid.origin,
            {1.0 / d.x, 1.0 / d.y, 1.0 / d.z},
            shortest / steps_per_cell};
  }
};

/// Cell that contains a sample, and the weights of the cell's eight nodes, which are products of (1 - t) or t along
/// each axis.
struct CellWeights {
  int cell[3];  ///< lowest node of the cell
  double t[3];  ///< position in the cell, 0 to 1
  GLADSTONE_HD double weight(int i, int j, int k) const {
    return (i ? t[0] : 1.0 - t[0]) * (j ? t[1] : 1.0 - t[1]) * (k ? t[2] : 1.0 - t[2]);
  }
};

/// Equidistant samples of the part of a sight line inside a volume (midpoint rule). The rule is exact for constant and
/// affine densities on parallel lines, and of second order in the spacing of the grid otherwise.
struct LineSamples {
  int count = 0;        ///< number of samples; 0: the line misses the volume
  double length = 0.0;  ///< distance between samples [m]
  double first = 0.0;   ///< distance of the first sample from the line's origin [m]
  Vec3d node{};         ///< first sample in grid coordinates [nodes]
  Vec3d advance{};      ///< vector from a sample to the next one [nodes]

  GLADSTONE_HD static LineSamples of(VolumeShape const& shape, SightLine const& line) {
    // Clip the line to the bounding box of the nodes, and to the section between dot and pupil.
    double from = line.is_parallel() ? -1e30 : 0.0, to = line.is_parallel() ? 1e30 : 0.999 * line.pupil_distance;
    for (int axis = 0; axis < 3; ++axis) {
      double const width = (shape.nodes[axis] - 1) / shape.inverse_spacing[axis];
      double const p = line.origin[axis] - shape.origin[axis], d = line.direction[axis];
      if (d == 0.0) {
        if (p < 0.0 || p > width) return {};
        continue;
      }
      double const a = -p / d, b = (width - p) / d;
      from = std::fmax(from, std::fmin(a, b));
      to = std::fmin(to, std::fmax(a, b));
    }
    if (!(to > from)) return {};
    LineSamples samples;
    samples.count = static_cast<int>(std::ceil((to - from) / shape.step));
    samples.length = (to - from) / samples.count;
    samples.first = from + 0.5 * samples.length;
    for (int axis = 0; axis < 3; ++axis) {
      double const p = line.origin[axis] - shape.origin[axis] + samples.first * line.direction[axis];
      samples.node[axis] = p * shape.inverse_spacing[axis];
      samples.advance[axis] = samples.length * line.direction[axis] * shape.inverse_spacing[axis];
    }
    return samples;
  }

  /// Returns the weight of sample i in the line integral [m].
  GLADSTONE_HD double weight(SightLine const& line, int i) const { return length * line.weight(first + i * length); }

  GLADSTONE_HD CellWeights cell(VolumeShape const& shape, int i) const {
    CellWeights at;
    for (int axis = 0; axis < 3; ++axis) {
      double const u = node[axis] + i * advance[axis];
      int const last = shape.nodes[axis] - 2;
      int cell = static_cast<int>(std::floor(u));
      cell = cell < 0 ? 0 : (cell > last ? last : cell);
      at.cell[axis] = cell;
      at.t[axis] = std::fmin(std::fmax(u - cell, 0.0), 1.0);
    }
    return at;
  }
};

/// Sum of the contributions of lines to a node, and sum of the weights of these contributions.
struct NodeSum {
  double value = 0.0;
  double weight = 0.0;
  GLADSTONE_HD void add(double line_weight, double line_value) {
    value += line_weight * line_value;
    weight += line_weight;
  }
};

/// Integrates a volume along a sight line: one row of the projection A.
struct LineProjection {
  VolumeShape shape;
  double const* values;  ///< value of every node [nodes]

  GLADSTONE_HD double operator()(SightLine const& line) const {
    LineSamples const samples = LineSamples::of(shape, line);
    std::ptrdiff_t const row = shape.nodes[0], plane = row * shape.nodes[1];
    double sum = 0.0;
    for (int i = 0; i < samples.count; ++i) {
      CellWeights const at = samples.cell(shape, i);
      double const* corner = values + at.cell[0] + row * at.cell[1] + plane * at.cell[2];
      double value = 0.0;
      for (int k = 0; k < 2; ++k)
        for (int j = 0; j < 2; ++j) {
          double const* pair = corner + row * j + plane * k;
          value += at.weight(0, j, k) * pair[0] + at.weight(1, j, k) * pair[1];
        }
      sum += samples.weight(line, i) * value;
    }
    return sum;
  }

  /// Returns the sum of the weights of a line, i.e. the projection of a volume of ones [m].
  GLADSTONE_HD static double row_sum(VolumeShape const& shape, SightLine const& line) {
    LineSamples const samples = LineSamples::of(shape, line);
    double sum = 0.0;
    for (int i = 0; i < samples.count; ++i) sum += samples.weight(line, i);
    return sum;
  }
};

/// Restricts a range of samples [begin, end) to those that may lie between two positions along an axis [nodes], with a
/// margin for rounding.
GLADSTONE_HD inline void limit_samples(LineSamples const& samples, int axis, double low, double high, int& begin,
                                       int& end) {
  double const start = samples.node[axis], advance = samples.advance[axis];
  if (std::fabs(advance) <= 1e-12) {
    double const stop = start + advance * samples.count;
    if (std::fmax(start, stop) < low - 1e-6 || std::fmin(start, stop) > high + 1e-6) end = begin;
    return;
  }
  double const a = (low - start) / advance, b = (high - start) / advance;
  double const first = std::floor(std::fmin(a, b)) - 1.0, last = std::ceil(std::fmax(a, b)) + 2.0;
  if (first > begin) begin = first < end ? static_cast<int>(first) : end;
  if (last < end) end = last > begin ? static_cast<int>(last) : begin;
}

/// Visits the samples of a sight line whose cells contain nodes within [low, high) along one axis, in their order along
/// the line.
/// @param add  called as add(node index, weight) for each node of a sample's cell that is within [low, high)
template <class Add>
GLADSTONE_HD void visit_slab(VolumeShape const& shape, SightLine const& line, int axis, int low, int high, Add&& add) {
  LineSamples const samples = LineSamples::of(shape, line);
  std::ptrdiff_t const row = shape.nodes[0], plane = row * shape.nodes[1];
  int begin = 0, end = samples.count;
  limit_samples(samples, axis, low - 1.0, high, begin, end);
  for (int i = begin; i < end; ++i) {
    CellWeights const at = samples.cell(shape, i);
    if (at.cell[axis] + 1 < low || at.cell[axis] >= high) continue;
    double const weight = samples.weight(line, i);
    for (int k = 0; k < 2; ++k)
      for (int j = 0; j < 2; ++j)
        for (int n = 0; n < 2; ++n) {
          int const offset[3] = {n, j, k};
          int const on_axis = at.cell[axis] + offset[axis];
          if (on_axis < low || on_axis >= high) continue;
          add(at.cell[0] + n + row * (at.cell[1] + j) + plane * (at.cell[2] + k), weight * at.weight(n, j, k));
        }
  }
}

/// Visits the samples of a sight line whose cells contain one given node, in their order along the line. The
/// contributions equal those of visit_slab() to this node. @param add called as add(weight) for each sample
template <class Add>
GLADSTONE_HD void visit_node(VolumeShape const& shape, SightLine const& line, LineSamples const& samples,
                             int const (&node)[3], Add&& add) {
  int begin = 0, end = samples.count;
  for (int axis = 0; axis < 3; ++axis) limit_samples(samples, axis, node[axis] - 1.0, node[axis] + 1.0, begin, end);
  for (int i = begin; i < end; ++i) {
    CellWeights const at = samples.cell(shape, i);
    int const n[3] = {node[0] - at.cell[0], node[1] - at.cell[1], node[2] - at.cell[2]};
    // skip unless the node is a corner of the cell: the offset is 0 or 1 along each axis
    if ((n[0] | n[1] | n[2]) & ~1) continue;
    add(samples.weight(line, i) * at.weight(n[0], n[1], n[2]));
  }
}

}  // namespace gladstone::inline tomography
