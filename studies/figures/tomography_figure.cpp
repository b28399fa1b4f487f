#include "studies/figures/tomography_figure.h"

#include <fmt/format.h>

#include "render/base/units.h"
#include "studies/figures/map_panels.h"

namespace gladstone::inline figures {

Figure make_tomography_figure(Tomography const& result) {
  RegularGrid const& grid = result.grid;
  int const columns = grid.nodes[0], rows = grid.nodes[2], middle = grid.nodes[1] / 2;
  auto const extract = [&](std::vector<double> const& values) {
    Image<double> map(columns, rows);
    for (int k = 0; k < rows; ++k)
      for (int i = 0; i < columns; ++i)
        map(i, rows - 1 - k) = values[static_cast<std::size_t>((k * grid.nodes[1] + middle) * columns + i)];
    return map;
  };
  MapFigure figure;
  figure.title = fmt::format("Density in the plane y = {:.4g} mm, from {} views",
                             (grid.origin.y + middle * grid.spacing.y) / unit::mm, result.views.size());
  double const step = grid.spacing.x / unit::mm, top = grid.origin.z + (rows - 1) * grid.spacing.z;
  figure.axes = {grid.origin.x / unit::mm, step, top / unit::mm, -step, false, "x [mm]", "z [mm]"};
  Image<double> const density = extract(result.density);
  if (!result.truth.empty()) {
    Image<double> const truth = extract(result.truth);
    Image<double> difference(columns, rows);
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column)
        difference(column, row) = density(column, row) - truth(column, row);
    figure.panels.push_back({"true ρ [kg/m³]", truth, ColourScale::sequential, "density"});
    figure.panels.push_back({"reconstructed ρ [kg/m³]", density, ColourScale::sequential, "density"});
    figure.panels.push_back({"difference [kg/m³]", difference, ColourScale::diverging});
  } else {
    figure.panels.push_back({"reconstructed ρ [kg/m³]", density, ColourScale::sequential});
  }
  figure.columns = static_cast<int>(figure.panels.size());
  return make_map_figure(figure);
}

}  // namespace gladstone::inline figures
