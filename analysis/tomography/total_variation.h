#pragma once

#include <array>
#include <vector>

#include "render/base/regular_grid.h"

namespace gladstone::tomography {

/// Total-variation denoising of a volume: minimises |x - g|^2 / 2 + lambda TV(x) by the dual projection of Chambolle,
/// J. Math. Imaging Vis. 20 (2004) 89. TV(x) is the sum over the nodes of the length of the gradient, by forward
/// differences, times the shortest spacing of the grid. The dual variable is kept from call to call, so that repeated
/// denoising of similar volumes converges.
class TotalVariation {
 public:
  explicit TotalVariation(RegularGrid const& grid);

  /// @param volume      g, replaced by the denoised volume [grid.size()]
  /// @param lambda      strength, in the unit of the volume; an isolated extremum is reduced by up to 6 lambda
  /// @param iterations  number of dual iterations
  void denoise(std::vector<double>& volume, double lambda, int iterations);
  /// Computes TV(x), in the unit of the volume.
  double compute(std::vector<double> const& volume) const;

 private:
  double diverge(std::size_t node, int i, int j, int k) const;
  Vec3d differentiate(std::vector<double> const& volume, std::size_t node, int i, int j, int k) const;
  template <class Body>
  void for_each_node(Body const& body) const;

  std::array<int, 3> nodes_;
  Vec3d ratio_;  ///< shortest spacing over the spacing along each axis [1]
  std::vector<Vec3d> dual_;
};

}  // namespace gladstone::tomography
