#pragma once

#include <vector>

#include "analysis/tomography/total_variation_stencil.h"
#include "render/base/regular_grid.h"

namespace gladstone::inline tomography {

/// Total-variation denoising of a volume: minimises |x - g|^2 / 2 + lambda TV(x) by the dual projection of Chambolle,
/// J. Math. Imaging Vis. 20 (2004) 89. TV(x) is the sum of the gradient's length over all nodes, computed by forward
/// differences, times the shortest spacing of the grid. The dual variable is retained between calls, so that repeated
/// denoising of similar volumes converges.
class TotalVariation {
 public:
  explicit TotalVariation(RegularGrid const& grid);

  /// @param volume  input: volume g; output: denoised volume [grid.size()]
  /// @param lambda      strength, in the unit of the volume; an isolated extremum is reduced by up to 6 lambda
  /// @param iterations  number of dual iterations
  void denoise(std::vector<double>& volume, double lambda, int iterations);
  /// Computes TV(x), in the unit of the volume.
  double compute(std::vector<double> const& volume) const;

 private:
  template <class Body>
  void for_each_node(Body const& body) const;

  TotalVariationStencil stencil_;
  std::vector<Vec3d> dual_;
};

}  // namespace gladstone::inline tomography
