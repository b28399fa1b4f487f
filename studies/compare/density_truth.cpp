#include "studies/compare/density_truth.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include "render/medium/field_volume.h"

namespace gladstone::inline compare {
namespace {

/// Nodes and weights of the interpolation along one axis.
struct LineWeights {
  int first = 0;
  std::array<double, 4> weight{};
  int count = 2;
};

/// @param position  in units of the spacing, from the first node
/// @param nodes     number of nodes
LineWeights weigh_line(double position, int nodes) {
  if (nodes == 1) return {0, {1.0}, 1};
  int const cell = std::clamp(static_cast<int>(std::floor(position)), 0, nodes - 2);
  double const t = position - cell;
  if (cell == 0 || cell == nodes - 2) return {cell, {1.0 - t, t}, 2};
  // cubic Lagrange interpolation, Abramowitz & Stegun 25.2.13
  return {cell - 1,
          {-t * (t - 1.0) * (t - 2.0) / 6.0, (t * t - 1.0) * (t - 2.0) / 2.0, -t * (t + 1.0) * (t - 2.0) / 2.0,
           t * (t * t - 1.0) / 6.0},
          4};
}

}  // namespace

std::vector<double> interpolate_density(FieldMap const& map, std::vector<Vec2d> const& position_px) {
  Vec2d const first = map.position_px(0, 0);
  std::vector<double> density;
  density.reserve(position_px.size());
  for (Vec2d const& p : position_px) {
    LineWeights const x = weigh_line((p.x - first.x) / map.spacing_px, map.density.columns());
    LineWeights const y = weigh_line((p.y - first.y) / map.spacing_px, map.density.rows());
    double sum = 0.0;
    for (int j = 0; j < y.count; ++j)
      for (int i = 0; i < x.count; ++i)
        sum += y.weight[static_cast<std::size_t>(j)] * x.weight[static_cast<std::size_t>(i)] *
               map.density(x.first + i, y.first + j);
    density.push_back(sum);
  }
  return density;
}

std::vector<double> sample_middle_plane(MediumSetup const& setup, density::PlaneGrid const& grid) {
  std::vector<double> density(grid.size(), setup.ambient_density);
  BuiltMedium const built = build_medium(setup);
  std::visit(
      [&](auto const& medium) {
        Bounds<double> const bounds = medium.bounds();
        for (int row = 0; row < grid.rows; ++row)
          for (int column = 0; column < grid.columns; ++column) {
            Vec2d const p = grid.position(column, row);
            bool const inside = p.x >= bounds.low.x && p.x <= bounds.high.x && p.y >= bounds.low.y &&
                                p.y <= bounds.high.y && bounds.low.z < 0.0 && bounds.high.z > 0.0;
            if (inside)
              density[grid.index(column, row)] =
                  medium.sample(Vec3d{p.x, p.y, 0.0}).refractivity / setup.gladstone_dale;
          }
      },
      built.view);
  return density;
}

}  // namespace gladstone::inline compare
