#include "studies/compare/tomography_file.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "render/base/units.h"
#include "render/files/hdf5_file.h"
#include "studies/case/result_rows.h"
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

/// Returns the quantities of the volume.
std::vector<ResultRow> volume_rows(Tomography const& result) {
  auto const [least, largest] = std::minmax_element(result.density.begin(), result.density.end());
  Vec3d const centre = find_grid_centre(result.grid);
  std::array<int, 3> const& nodes = result.grid.nodes;
  std::vector<ResultRow> rows{
      count_row("nodes.0", "nodes along x", nodes[0]),
      count_row("nodes.1", "nodes along y", nodes[1]),
      count_row("nodes.2", "nodes along z", nodes[2]),
      plain_row("spacing_mm", "spacing", result.grid.spacing.x / unit::mm, "mm"),
      plain_row("center_mm.0", "centre of the volume, x", centre.x / unit::mm, "mm"),
      plain_row("center_mm.1", "centre of the volume, y", centre.y / unit::mm, "mm"),
      plain_row("center_mm.2", "centre of the volume, z", centre.z / unit::mm, "mm"),
      plain_row("reference_density_kg_m3", "reference density", result.reference_density, "kg/m^3"),
      plain_row("density_kg_m3.least", "density, least", *least, "kg/m^3"),
      plain_row("density_kg_m3.largest", "density, largest", *largest, "kg/m^3"),
      count_row("iterations", "sweeps over all views", result.residual.size()),
      plain_row("tv_weight", "strength of the total variation", result.tv_weight),
      plain_row("residual", "residual of the line integrals", result.residual.back()),
      plain_row("outside", "line integrals outside of the volume", result.outside, "", "fraction of their squares")};
  if (!result.truth.empty())
    rows.push_back(
        plain_row("relative_error", "relative L2 error of the density difference", compute_relative_error(result)));
  return rows;
}

/// Returns the quantities of each view.
std::vector<ResultGroup> view_groups(Tomography const& result) {
  std::vector<ResultGroup> groups;
  for (std::size_t i = 0; i < result.views.size(); ++i)
    groups.push_back({result.views[i],
                      {plain_row("angles_deg", "angle", result.angles[i] / unit::degree, "deg"),
                       count_row("vectors", "vectors", result.vectors[i]),
                       plain_row("view_residual", "residual", result.view_residual[i])}});
  return groups;
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

std::vector<ResultRow> tomography_rows(Tomography const& result) {
  std::vector<ResultRow> rows = volume_rows(result);
  std::vector<ResultGroup> const views = view_groups(result);
  for (std::size_t i = 0; i < views.size(); ++i)
    for (ResultRow row : views[i].rows) {
      row.key += fmt::format(".{}", i);
      row.label += " of " + views[i].name;
      rows.push_back(std::move(row));
    }
  return rows;
}

nlohmann::ordered_json summarize_tomography(Tomography const& result) {
  nlohmann::ordered_json json{{"views", result.views}, {"device", result.device}};
  json.update(rows_json(tomography_rows(result)));
  return json;
}

std::string tomography_report(Tomography const& result) {
  return "Density of a volume\n" + rows_text(volume_rows(result)) + groups_text("view", view_groups(result));
}

}  // namespace gladstone::inline compare
