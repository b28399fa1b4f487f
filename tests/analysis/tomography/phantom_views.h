#pragma once

#include <cmath>
#include <vector>

#include "analysis/tomography/volume_reconstruction.h"

namespace gladstone::inline tomography {

/// Returns the grid of a cube of the given width about the origin [m].
inline RegularGrid make_cube(int nodes, double width) {
  double const spacing = width / (nodes - 1);
  return {{nodes, nodes, nodes}, {spacing, spacing, spacing}, {-0.5 * width, -0.5 * width, -0.5 * width}};
}

/// Calls body(position) for each node, in the order in which nodes are stored.
template <class Body>
void visit_cube(RegularGrid const& grid, Body const& body) {
  for (int k = 0; k < grid.nodes[2]; ++k)
    for (int j = 0; j < grid.nodes[1]; ++j)
      for (int i = 0; i < grid.nodes[0]; ++i)
        body(grid.origin + Vec3d{i * grid.spacing.x, j * grid.spacing.y, k * grid.spacing.z});
}

/// Returns the Gaussian exp(-|p - centre|^2 / radius^2) at the nodes.
inline std::vector<double> sample_blob(RegularGrid const& grid, double radius, Vec3d centre = {}) {
  std::vector<double> values;
  visit_cube(grid, [&](Vec3d p) { values.push_back(std::exp(-dot(p - centre, p - centre) / (radius * radius))); });
  return values;
}

/// Returns parallel views of a Gaussian blob, at equal angles about Y over 180 degrees, with its exact line integrals.
inline std::vector<ProjectedView> view_blob(int views, int across, double width, double radius, Vec3d centre = {}) {
  std::vector<ProjectedView> all;
  double const spacing = width / (across - 1);
  for (int v = 0; v < views; ++v) {
    double const angle = M_PI * v / views;
    Vec3d const along{std::sin(angle), 0.0, std::cos(angle)}, right{std::cos(angle), 0.0, -std::sin(angle)};
    ProjectedView view;
    view.name = "view";
    for (int row = 0; row < across; ++row)
      for (int column = 0; column < across; ++column) {
        SightLine line;
        line.direction = along;
        line.origin = (column * spacing - 0.5 * width) * right + Vec3d{0.0, row * spacing - 0.5 * width, 0.0};
        Vec3d const from_centre = line.origin - centre;
        double const miss2 = dot(from_centre, from_centre) - std::pow(dot(from_centre, along), 2);
        view.lines.push_back(line);
        view.value.push_back(std::sqrt(M_PI) * radius * std::exp(-miss2 / (radius * radius)));
      }
    all.push_back(std::move(view));
  }
  return all;
}

}  // namespace gladstone::inline tomography
