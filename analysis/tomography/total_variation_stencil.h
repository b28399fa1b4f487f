#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "render/base/host_device.h"
#include "render/base/regular_grid.h"
#include "render/base/vec.h"

namespace gladstone::inline tomography {

/// Differences between neighbouring nodes of a volume, and the step of the dual iteration of Chambolle, J. Math.
/// Imaging Vis. 20 (2004) 89, at one node. Passed by value. The x index of the nodes varies fastest in memory.
struct TotalVariationStencil {
  /// Largest stable step of the dual iteration: 1 / |gradient|^2. The squared norm of the gradient operator is at most
  /// 4 for each of the three axes.
  static constexpr double dual_step = 1.0 / 12.0;

  int nodes[3] = {2, 2, 2};
  Vec3d ratio{1.0, 1.0, 1.0};  ///< ratio of the shortest spacing to the spacing along each axis [1]

  static TotalVariationStencil of(RegularGrid const& grid) {
    Vec3d const d = grid.spacing;
    double const shortest = std::min({d.x, d.y, d.z});
    return {{grid.nodes[0], grid.nodes[1], grid.nodes[2]}, {shortest / d.x, shortest / d.y, shortest / d.z}};
  }

  GLADSTONE_HD std::ptrdiff_t index(int i, int j, int k) const {
    return i + nodes[0] * (j + static_cast<std::ptrdiff_t>(nodes[1]) * k);
  }

  /// Returns the forward differences of a volume at a node; zero at the upper end of an axis.
  GLADSTONE_HD Vec3d differentiate(double const* volume, int i, int j, int k) const {
    std::ptrdiff_t const row = nodes[0], plane = row * nodes[1], node = index(i, j, k);
    double const here = volume[node];
    return {i + 1 < nodes[0] ? ratio.x * (volume[node + 1] - here) : 0.0,
            j + 1 < nodes[1] ? ratio.y * (volume[node + row] - here) : 0.0,
            k + 1 < nodes[2] ? ratio.z * (volume[node + plane] - here) : 0.0};
  }

  /// Returns the divergence of the dual variable at a node; it is the negative adjoint of differentiate().
  GLADSTONE_HD double diverge(Vec3d const* dual, int i, int j, int k) const {
    std::ptrdiff_t const row = nodes[0], plane = row * nodes[1], node = index(i, j, k);
    Vec3d const here = dual[node];
    double sum = 0.0;
    if (i + 1 < nodes[0]) sum += ratio.x * here.x;
    if (i > 0) sum -= ratio.x * dual[node - 1].x;
    if (j + 1 < nodes[1]) sum += ratio.y * here.y;
    if (j > 0) sum -= ratio.y * dual[node - row].y;
    if (k + 1 < nodes[2]) sum += ratio.z * here.z;
    if (k > 0) sum -= ratio.z * dual[node - plane].z;
    return sum;
  }

  /// Returns the denoised value of a node for the current dual variable.
  GLADSTONE_HD double denoise(double const* volume, Vec3d const* dual, double lambda, int i, int j, int k) const {
    return volume[index(i, j, k)] + lambda * diverge(dual, i, j, k);
  }

  /// Returns the dual variable of a node after a step, shortened to a length of at most 1.
  GLADSTONE_HD Vec3d project(double const* denoised, Vec3d const* dual, double lambda, int i, int j, int k) const {
    Vec3d const p = dual[index(i, j, k)] + (dual_step / lambda) * differentiate(denoised, i, j, k);
    return p / std::fmax(1.0, length(p));
  }
};

}  // namespace gladstone::inline tomography
