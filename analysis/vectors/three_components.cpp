#include "analysis/vectors/three_components.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstdlib>

#include "analysis/vectors/vector_writers/vector_columns.h"
#include "analysis/vectors/vector_writers/vector_writers.h"
#include "render/base/error.h"

namespace gladstone::inline vectors {
namespace {

constexpr char const* stereo_filetype = "gladstone stereo";

/// Reads datasets of a file and checks their sizes.
class NodeReader {
 public:
  explicit NodeReader(std::string const& path) : path_(path), file_(path) {
    if (file_.attribute("filetype") != stereo_filetype)
      throw DataError(ErrorCode::wrong_format, path,
                      "contains no displacements with three components; give a file that gladstone stereo has written");
  }

  std::vector<double> read(std::string const& dataset, std::size_t count) const {
    if (!file_.has(dataset))
      throw DataError(ErrorCode::missing_content, path_,
                      fmt::format("has no dataset {}; run gladstone stereo again", dataset));
    std::vector<double> values = file_.read(dataset);
    if (values.size() != count && count > 0)
      throw DataError(ErrorCode::wrong_shape, path_,
                      fmt::format("{}: {} values where the grid requires {}", dataset, values.size(), count));
    return values;
  }
  std::vector<double> read_axis(std::string const& dataset) const { return read(dataset, 0); }
  std::vector<Vec3d> read_vectors(std::string const& dataset, std::size_t nodes) const {
    std::vector<double> const values = read(dataset, 3 * nodes);
    std::vector<Vec3d> vectors;
    for (std::size_t i = 0; i < nodes; ++i) vectors.push_back({values[3 * i], values[3 * i + 1], values[3 * i + 2]});
    return vectors;
  }
  double number(std::string const& attribute) const { return std::strtod(file_.attribute(attribute).c_str(), nullptr); }

 private:
  std::string path_;
  Hdf5Reader file_;
};

std::vector<double> pick_values(std::vector<Vec3d> const& vectors, int axis) {
  std::vector<double> values;
  for (Vec3d const& vector : vectors) values.push_back(vector[axis]);
  return values;
}

/// Returns the columns x_mm, y_mm, z_mm, u_mm, v_mm, w_mm, sigma_u_mm, sigma_v_mm, sigma_w_mm, residual_px,
/// residual_ratio and status.
VectorTable make_table(ThreeComponentField const& field) {
  std::vector<double> x, y;
  for (double const row : field.y_mm)
    for (double const column : field.x_mm) {
      x.push_back(column);
      y.push_back(row);
    }
  VectorTable table;
  table.grid_columns = static_cast<int>(field.x_mm.size());
  table.grid_rows = static_cast<int>(field.y_mm.size());
  table.remark = "mm, axes of the world";
  auto const add = [&](char const* name, char const* units, char const* description, std::vector<double> values) {
    table.columns.push_back(number_column(name, units, description, std::move(values)));
  };
  add("x_mm", "mm", "X of the node", std::move(x));
  add("y_mm", "mm", "Y of the node", std::move(y));
  add("z_mm", "mm", "Z of the node, on the laser sheet", field.z_mm);
  add("u_mm", "mm", "displacement along X", pick_values(field.displacement_mm, 0));
  add("v_mm", "mm", "displacement along Y", pick_values(field.displacement_mm, 1));
  add("w_mm", "mm", "displacement along Z", pick_values(field.displacement_mm, 2));
  add("sigma_u_mm", "mm", "standard uncertainty of u", pick_values(field.sigma_mm, 0));
  add("sigma_v_mm", "mm", "standard uncertainty of v", pick_values(field.sigma_mm, 1));
  add("sigma_w_mm", "mm", "standard uncertainty of w", pick_values(field.sigma_mm, 2));
  add("residual_px", "px", "residual of the four equations", field.residual_px);
  add("residual_ratio", "1", "residual divided by its standard uncertainty", field.residual_ratio);
  table.columns.push_back(status_column(field.status, field.size()));
  return table;
}

constexpr std::array variables{
    NetcdfVariable{"u", "u_mm", "mm", "displacement along x", "u_velocity"},
    NetcdfVariable{"v", "v_mm", "mm", "displacement along y", "v_velocity"},
    NetcdfVariable{"w", "w_mm", "mm", "displacement along z", "w_velocity"},
    NetcdfVariable{"sigma_u", "sigma_u_mm", "mm", "standard uncertainty of u", ""},
    NetcdfVariable{"sigma_v", "sigma_v_mm", "mm", "standard uncertainty of v", ""},
    NetcdfVariable{"sigma_w", "sigma_w_mm", "mm", "standard uncertainty of w", ""},
    NetcdfVariable{"z", "z_mm", "mm", "z of the node, on the laser sheet", ""},
    NetcdfVariable{"residual", "residual_px", "pix", "residual of the four equations", ""},
    NetcdfVariable{"residual_ratio", "residual_ratio", "1", "residual over its standard uncertainty", ""},
    NetcdfVariable{"status", "status", "1", "0 valid, 3 invalid", ""},
};

void write_netcdf(std::string const& path, ThreeComponentField const& field, FileOrigin const& origin) {
  write_netcdf_table(path, make_table(field),
                     {{field.x_mm, field.y_mm}, "mm", "X of the world", "Y of the world, upwards"}, variables, origin);
}

VtkLayout make_layout() {
  return {{"position_mm", {"x_mm", "y_mm", "z_mm"}},
          {{"displacement_mm", {"u_mm", "v_mm", "w_mm"}}, {"sigma_mm", {"sigma_u_mm", "sigma_v_mm", "sigma_w_mm"}}}};
}

/// Writes a VTK image, which is in the plane z = 0; the z of the nodes is stored as an array.
void write_vti(std::string const& path, ThreeComponentField const& field, FileOrigin const& origin) {
  VtkLayout layout = make_layout();
  layout.position.components[2].clear();
  write_vti_table(path, make_table(field), {field.x_mm, field.y_mm}, layout, origin);
}

/// Writer of a format, selected by the extension of the file. A new format requires one more row.
struct ThreeComponentWriter {
  char const* extension;
  void (*write)(std::string const& path, ThreeComponentField const& field, FileOrigin const& origin);
};
constexpr std::array writers{
    ThreeComponentWriter{".csv", [](auto const& path, auto const& field,
                                    auto const& origin) { write_csv_table(path, make_table(field), origin); }},
    ThreeComponentWriter{".nc", write_netcdf},
    ThreeComponentWriter{".mat", [](auto const& path, auto const& field,
                                    auto const& origin) { write_matlab_table(path, make_table(field), origin); }},
    ThreeComponentWriter{".dat", [](auto const& path, auto const& field,
                                    auto const& origin) { write_tecplot_table(path, make_table(field), origin); }},
    ThreeComponentWriter{".vti", write_vti},
    ThreeComponentWriter{".vtp",
                         [](auto const& path, auto const& field, auto const& origin) {
                           write_vtp_table(path, make_table(field), make_layout(), origin);
                         }},
};

}  // namespace

bool is_three_component_file(std::string const& path) {
  return has_hdf5_ending(path) && Hdf5Reader(path).attribute("filetype") == stereo_filetype;
}

ThreeComponentField read_three_components(std::string const& path) {
  NodeReader const file(path);
  ThreeComponentField field;
  field.x_mm = file.read_axis("/x_mm");
  field.y_mm = file.read_axis("/y_mm");
  std::size_t const nodes = field.x_mm.size() * field.y_mm.size();
  if (nodes == 0) throw DataError(ErrorCode::missing_content, path, "contains no nodes");
  field.displacement_mm = file.read_vectors("/displacement_mm", nodes);
  field.sigma_mm = file.read_vectors("/sigma_mm", nodes);
  field.residual_px = file.read("/residual_px", nodes);
  field.residual_ratio = file.read("/residual_ratio", nodes);
  for (double const code : file.read("/status", nodes))
    field.status.push_back(code == 0.0 ? VectorStatus::valid : VectorStatus::invalid);
  double const z = file.number("sheet_z_mm"), by_x = file.number("sheet_slope_x"), by_y = file.number("sheet_slope_y");
  for (double const y : field.y_mm)
    for (double const x : field.x_mm) field.z_mm.push_back(z + by_x * x + by_y * y);
  return field;
}

std::vector<std::string> three_component_extensions() {
  std::vector<std::string> names;
  for (ThreeComponentWriter const& writer : writers) names.emplace_back(writer.extension);
  return names;
}

void write_three_components(std::string const& path, ThreeComponentField const& field, FileOrigin const& origin) {
  auto const* const writer =
      std::find_if(writers.begin(), writers.end(), [&](auto const& one) { return path.ends_with(one.extension); });
  if (writer == writers.end())
    throw OutputError(path, fmt::format("three components are written as {}; use one of these endings",
                                        fmt::join(three_component_extensions(), ", ")));
  writer->write(path, field, origin);
}

}  // namespace gladstone::inline vectors
