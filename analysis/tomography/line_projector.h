#pragma once

#include <span>
#include <vector>

#include "analysis/tomography/line_samples.h"
#include "render/base/regular_grid.h"

namespace gladstone::inline tomography {

/// Projection A of a volume to its line integrals along the sight lines of one view, and the adjoint of A. The matrix A
/// is not stored. Every sum has a fixed order, so that results do not depend on the number of threads.
class LineProjector {
 public:
  /// @param lines  sight lines of the view; must outlive the projector
  LineProjector(RegularGrid const& grid, std::span<SightLine const> lines);

  /// Projects a volume, A x.
  /// @param volume  value of every node [grid.size()]
  /// @return        line integrals, in the unit of the volume times m [lines]
  std::vector<double> project(std::span<double const> volume) const;
  /// Computes the adjoint A' y, and the sum of the weights of each node, A' 1, over the lines with a finite value.
  /// @param values  value of each line [lines]; NaN: the line is ignored
  void back_project(std::span<double const> values, std::vector<NodeSum>& sums) const;
  /// Returns the sum of the weights of each line, A 1 [m, lines]; 0: the line misses the volume.
  std::vector<double> const& row_sums() const { return row_sums_; }
  std::span<SightLine const> lines() const { return lines_; }

 private:
  VolumeShape shape_;
  std::span<SightLine const> lines_;
  std::vector<double> row_sums_;
  /// Axis along which the volume is divided between threads: the one along which the lines advance least.
  int slab_axis_;
};

}  // namespace gladstone::inline tomography
