#pragma once

#include <cstddef>
#include <functional>
#include <span>

#include "render/medium/medium.h"

namespace gladstone::test {

/// Refractivity as a function of the world position of a node.
using Refractivity = std::function<double(Vec3d)>;

/// Returns a grid of nodes whose first node is at `origin`.
inline RegularGrid open_grid(int nx, int ny, int nz, Vec3d spacing = {1, 1, 1}, Vec3d origin = {}) {
  RegularGrid grid;
  grid.nodes = {nx, ny, nz};
  grid.spacing = spacing;
  grid.origin = origin;
  return grid;
}

/// Evaluates a function at the nodes and rounds it to float, as if it were read from a file.
template <class Stored>
RefractiveIndexVolume<Stored> sampled(RegularGrid const& grid, Refractivity const& f, bool spline = true) {
  using Volume = RefractiveIndexVolume<Stored>;
  auto const fill = [&](int first, int count, std::span<double> out) {
    std::size_t at = 0;
    for (int k = first; k < first + count; ++k) {
      for (int j = 0; j < grid.nodes[1]; ++j) {
        for (int i = 0; i < grid.nodes[0]; ++i) {
          Vec3d const node{grid.origin.x + i * grid.spacing.x, grid.origin.y + j * grid.spacing.y,
                           grid.origin.z + k * grid.spacing.z};
          out[at++] = static_cast<float>(f(node));
        }
      }
    }
  };
  return Volume(grid, spline ? Volume::Interpolation::cubic_bspline : Volume::Interpolation::trilinear, 1.0, 0.0, fill);
}

}  // namespace gladstone::test
