#include "studies/compare/tomography_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>

#include "render/base/units.h"
#include "render/files/hdf5_file.h"
#include "studies/case/json_text.h"
#include "studies/compare/density_table.h"

namespace gladstone::inline compare {
namespace {

constexpr char const* volume_axes = "z, y, x (ascending)";

void write_tomography_attributes(Hdf5Writer& file, Tomography const& result) {
  Vec3d const centre = find_grid_centre(result.grid);
  file.attribute("/", "reference_density_kg_m3", result.reference_density);
  for (int axis = 0; axis < 3; ++axis)
    file.attribute("/", std::string("center_") + "xyz"[axis] + "_mm", centre[axis] / unit::mm);
  file.attribute("/", "iterations", static_cast<std::int64_t>(result.residual.size()));
  file.attribute("/", "relaxation", result.settings.relaxation);
  file.attribute("/", "tv_weight", result.tv_weight);
  file.attribute("/", "residual", result.residual.back());
  if (!result.truth.empty()) file.attribute("/", "relative_error", compute_relative_error(result));
}

}  // namespace

Vec3d find_grid_centre(RegularGrid const& grid) {
  Vec3d centre = grid.origin;
  for (int axis = 0; axis < 3; ++axis)
    centre[axis] += 0.5 * (grid.nodes[static_cast<std::size_t>(axis)] - 1) * grid.spacing[axis];
  return centre;
}

void write_density_volume(std::string const& path, RegularGrid const& grid, std::vector<double> const& density,
                          std::string const& setup) {
  Hdf5Writer file(path, {"gladstone volume", 1, setup});
  Hdf5Axes axes(file);
  GridTable table{make_volume_axes(grid), {}};
  table.columns.push_back(number_column("density_kg_m3", "kg/m^3", "density", density));
  write_grid_datasets(file, axes, table, volume_axes);
  axes.attach();
  file.close();
}

void write_tomography(std::string const& path, Tomography const& result) {
  FileOrigin const origin{"gladstone tomography", 1, result.setup, result.seed, result.device, result.sources};
  GridTable const table = make_volume_table(result);
  if (!path.ends_with(".h5")) return write_grid_table(path, table, origin);
  Hdf5Writer file(path, origin);
  Hdf5Axes axes(file);
  write_grid_datasets(file, axes, table, volume_axes);
  std::vector<double> angles = result.angles;
  for (double& angle : angles) angle /= unit::degree;
  axes.write_numbers("/view", angles.size(), "number of the view");
  file.write("/angle_deg", std::span<double const>(angles), {angles.size()}, "deg",
             "right-handed angle of the volume about Y in each view", "view");
  axes.name("/angle_deg", {"/view"});
  axes.write_numbers("/iteration", result.residual.size(), "number of the sweep over all views, from 0");
  file.write("/residual", std::span<double const>(result.residual), {result.residual.size()}, "1",
             "norm of the residual line integrals over that of the measured ones", "iteration");
  axes.name("/residual", {"/iteration"});
  file.write("/view_residual", std::span<double const>(result.view_residual), {result.view_residual.size()}, "1",
             "rms residual of the line integrals of each view over the rms line integral of all views", "view");
  axes.name("/view_residual", {"/view"});
  axes.attach();
  write_tomography_attributes(file, result);
  file.close();
}

nlohmann::ordered_json summarize_tomography(Tomography const& result) {
  auto const [least, largest] = std::minmax_element(result.density.begin(), result.density.end());
  Vec3d const centre = find_grid_centre(result.grid);
  std::vector<double> angles = result.angles;
  for (double& angle : angles) angle /= unit::degree;
  nlohmann::ordered_json json{{"views", result.views},
                              {"angles_deg", angles},
                              {"vectors", result.vectors},
                              {"nodes", result.grid.nodes},
                              {"spacing_mm", result.grid.spacing.x / unit::mm},
                              {"center_mm", {centre.x / unit::mm, centre.y / unit::mm, centre.z / unit::mm}},
                              {"reference_density_kg_m3", result.reference_density},
                              {"density_kg_m3", {{"least", *least}, {"largest", *largest}}},
                              {"iterations", result.residual.size()},
                              {"tv_weight", result.tv_weight},
                              {"device", result.device},
                              {"residual", result.residual.back()},
                              {"view_residual", result.view_residual},
                              {"outside", result.outside}};
  if (!result.truth.empty()) json["relative_error"] = number_or_null(compute_relative_error(result));
  return json;
}

std::string tomography_report(Tomography const& result) {
  auto const [least, largest] = std::minmax_element(result.density.begin(), result.density.end());
  Vec3d const centre = find_grid_centre(result.grid);
  std::string text = fmt::format(
      "Density at {} x {} x {} nodes, {:.4g} mm apart, from {} views: {:.5g} to {:.5g} kg/m^3\n"
      "  centre of the volume ({:.6g}, {:.6g}, {:.6g}) mm; residual of the line integrals {:.2f} % after {} "
      "iterations\n",
      result.grid.nodes[0], result.grid.nodes[1], result.grid.nodes[2], result.grid.spacing.x / unit::mm,
      result.views.size(), *least, *largest, centre.x / unit::mm, centre.y / unit::mm, centre.z / unit::mm,
      100.0 * result.residual.back(), result.residual.size());
  for (std::size_t i = 0; i < result.views.size(); ++i)
    text += fmt::format("  {} ({:.4g} deg): {} vectors, residual {:.2f} %\n", result.views[i],
                        result.angles[i] / unit::degree, result.vectors[i], 100.0 * result.view_residual[i]);
  if (!result.truth.empty())
    text += fmt::format("  relative L2 error of the density difference: {:.4f}\n", compute_relative_error(result));
  return text;
}

}  // namespace gladstone::inline compare
