#include "studies/figures/density_figure.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "studies/figures/map_panels.h"

namespace gladstone {
namespace {

/// Converts a field with rows upwards to a map with rows downwards.
Image<double> make_map(density::PlaneGrid const& grid, std::vector<double> const& values) {
  Image<double> map(grid.columns, grid.rows);
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column)
      map(column, grid.rows - 1 - row) = values[grid.index(column, row)];
  return map;
}

}  // namespace

void write_density_figure(std::string const& path, Reconstruction const& reconstruction) {
  density::PlaneGrid const& grid = reconstruction.grid;
  Vec2d const top = grid.position(0, grid.rows - 1);
  MapFigure figure;
  figure.title = reconstruction.axisymmetry ? "Density in the plane through the axis"
                                            : "Density, mean over the thickness of the medium";
  figure.axes = {1e3 * top.x, 1e3 * grid.spacing.x, 1e3 * top.y, -1e3 * grid.spacing.y, false, "x [mm]", "y [mm]"};
  bool const has_truth = !reconstruction.truth.empty();
  bool const has_sigma = std::any_of(reconstruction.sigma.begin(), reconstruction.sigma.end(),
                                     [](double sigma) { return std::isfinite(sigma); });
  figure.panels.push_back(
      {"ρ [kg/m³]", make_map(grid, reconstruction.density), ColourScale::sequential, has_truth ? "density" : ""});
  if (has_truth)
    figure.panels.push_back(
        {"true ρ [kg/m³]", make_map(grid, reconstruction.truth), ColourScale::sequential, "density"});
  if (has_sigma)
    figure.panels.push_back(
        {"standard uncertainty of ρ [kg/m³]", make_map(grid, reconstruction.sigma), ColourScale::magnitude});
  if (has_truth) {
    std::vector<double> error(reconstruction.density);
    for (std::size_t i = 0; i < error.size(); ++i) error[i] -= reconstruction.truth[i];
    figure.panels.push_back({"error of ρ [kg/m³]", make_map(grid, error), ColourScale::diverging});
  }
  figure.columns = std::min<int>(2, static_cast<int>(figure.panels.size()));
  write_map_figure(path, figure);
}

}  // namespace gladstone
