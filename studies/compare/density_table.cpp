#include "studies/compare/density_table.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <functional>
#include <span>

#include "render/base/error.h"
#include "render/base/units.h"

namespace gladstone::inline compare {
namespace {

constexpr char const* gradient_dataset = "/gradient_kg_m4";

void add_column(GridTable& table, char const* name, char const* units, char const* description,
                std::vector<double> values) {
  table.columns.push_back(number_column(name, units, description, std::move(values)));
}

void add_codes(GridTable& table, char const* name, char const* description, std::vector<std::int64_t> const& codes) {
  add_column(table, name, "1", description, {codes.begin(), codes.end()});
  table.columns.back().is_code = true;
}

/// Adds truth and error of a rendered case. @param density  measured density
void add_truth(GridTable& table, std::vector<double> const& density, std::vector<double> const& truth) {
  if (truth.empty()) return;
  std::vector<double> error(density.size());
  std::transform(density.begin(), density.end(), truth.begin(), error.begin(), std::minus<>{});
  add_column(table, "truth_kg_m3", "kg/m^3", "true density of the rendered case", truth);
  add_column(table, "error_kg_m3", "kg/m^3", "density minus true density", std::move(error));
}

}  // namespace

GridTable make_density_table(Reconstruction const& reconstruction) {
  density::PlaneGrid const& grid = reconstruction.grid;
  GridTable table;
  table.axes = {{"y", {}, "position in the mid-plane of the medium, above the optical axis"},
                {"x", {}, "position in the mid-plane of the medium, to the right of the optical axis"}};
  for (int row = 0; row < grid.rows; ++row) table.axes[0].place_mm.push_back(1e3 * grid.position(0, row).y);
  for (int column = 0; column < grid.columns; ++column)
    table.axes[1].place_mm.push_back(1e3 * grid.position(column, 0).x);
  add_column(table, "density_kg_m3", "kg/m^3",
             reconstruction.axisymmetry ? "density in the plane through the axis; NaN: not determined"
                                        : "density, mean over the thickness of the medium; NaN: not determined",
             reconstruction.density);
  add_column(table, "sigma_kg_m3", "kg/m^3",
             "standard uncertainty of the density: vectors, reference density and scale; NaN: unknown",
             reconstruction.sigma);
  add_column(table, "sigma_random_kg_m3", "kg/m^3", "the part of the uncertainty that is due to the vectors",
             reconstruction.sigma_random);
  add_codes(table, "region", "connected region of valid vectors, 0: the largest; -1: no valid vector",
            reconstruction.region);
  add_codes(table, "reference", "1: node with the reference density", reconstruction.reference);
  add_truth(table, reconstruction.density, reconstruction.truth);
  return table;
}

void add_gradient_columns(GridTable& table, std::vector<Vec2d> const& gradient) {
  std::vector<double> x, y;
  for (Vec2d const& g : gradient) {
    x.push_back(g.x);
    y.push_back(g.y);
  }
  add_column(table, "gradient_x_kg_m4", "kg/m^4", "density gradient along x", std::move(x));
  add_column(table, "gradient_y_kg_m4", "kg/m^4", "density gradient along y", std::move(y));
}

std::vector<TableAxis> make_volume_axes(RegularGrid const& grid) {
  std::vector<TableAxis> axes;
  for (int axis = 2; axis >= 0; --axis) {
    TableAxis& one =
        axes.emplace_back(TableAxis{std::string(1, "xyz"[axis]), {}, "position in the frame of the volume"});
    for (int i = 0; i < grid.nodes[static_cast<std::size_t>(axis)]; ++i)
      one.place_mm.push_back((grid.origin[axis] + i * grid.spacing[axis]) / unit::mm);
  }
  return axes;
}

GridTable make_volume_table(Tomography const& result) {
  GridTable table;
  table.axes = make_volume_axes(result.grid);
  add_column(table, "density_kg_m3", "kg/m^3",
             "reconstructed density; the reference density where no view sees the node", result.density);
  add_codes(table, "views", "number of views with a line of sight through the cells of the node", result.seen);
  add_truth(table, result.density, result.truth);
  return table;
}

void write_grid_datasets(Hdf5Writer& file, Hdf5Axes& axes, GridTable const& table, std::string const& order) {
  std::vector<std::string> scales;
  for (TableAxis const& axis : table.axes) {
    scales.push_back('/' + axis.name + "_mm");
    file.write(scales.back(), std::span<double const>(axis.place_mm), {axis.place_mm.size()}, "mm", axis.description,
               axis.name);
  }
  for (VectorColumn const& column : table.columns) {
    std::string const name = '/' + column.name;
    if (column.is_code) {
      std::vector<std::int64_t> const codes(column.values.begin(), column.values.end());
      file.write(name, std::span<std::int64_t const>(codes), table.shape(), column.units, column.description, order);
    } else {
      file.write(name, std::span<double const>(column.values), table.shape(), column.units, column.description, order);
    }
    axes.name(name, scales);
  }
}

void require_density_ending(std::string const& path) {
  std::vector<std::string> endings = grid_table_extensions();
  endings.insert(endings.begin(), ".h5");
  if (std::any_of(endings.begin(), endings.end(), [&](std::string const& ending) { return path.ends_with(ending); }))
    return;
  throw OutputError(path, fmt::format("must end in one of {}, which selects the format", fmt::join(endings, ", ")));
}

bool is_density_file(std::string const& path) {
  if (!has_hdf5_ending(path)) return false;
  std::string const type = Hdf5Reader(path).attribute("filetype");
  return type == "gladstone density" || type == "gladstone tomography" || type == "gladstone volume";
}

ExportedDensity load_density_for_export(std::string const& path) {
  ExportedDensity exported;
  Hdf5Reader const file(path);
  exported.format = file.attribute("filetype");
  exported.origin.filetype = exported.format;
  exported.origin.setup = file.attribute("setup");
  exported.origin.device = file.attribute("device");
  exported.origin.sources.add("density", path, SourceFiles::Holds::datasets);
  GridTable& table = exported.table;
  for (std::string const axis : {"z", "y", "x"}) {
    std::string const name = '/' + axis + "_mm";
    if (file.has(name)) table.axes.push_back({axis, file.read(name), file.attribute_of(name, "description")});
  }
  std::vector<std::size_t> const shape = table.shape();
  for (std::string const& name : file.dataset_names()) {
    if (shape.size() < 2 || file.shape('/' + name) != shape) continue;
    std::string const units = file.attribute_of('/' + name, "units");
    table.columns.push_back({name, units, file.attribute_of('/' + name, "description"), units == "1", file.read(name)});
  }
  if (table.columns.empty()) {
    throw DataError(ErrorCode::missing_content, path,
                    "contains no density on a grid; give a file of gladstone reconstruct or tomography");
  }
  if (file.has(gradient_dataset)) {
    std::vector<double> const numbers = file.read(gradient_dataset);
    if (numbers.size() != 2 * table.nodes())
      throw DataError(ErrorCode::wrong_shape, path, "has a gradient of another shape than the density");
    std::vector<Vec2d> gradient;
    for (std::size_t i = 0; i < numbers.size(); i += 2) gradient.push_back({numbers[i], numbers[i + 1]});
    add_gradient_columns(table, gradient);
  }
  return exported;
}

}  // namespace gladstone::inline compare
