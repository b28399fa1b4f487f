#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstdint>

#include "analysis/vectors/vector_writers/vector_columns.h"
#include "analysis/vectors/vector_writers/vector_writers.h"
#include "render/base/error.h"
#include "render/files/base64.h"

namespace gladstone::detail {
namespace {

/// Returns a <DataArray> with its values in base64: the number of bytes, then the bytes.
template <class Value>
std::string data_array(std::string const& type, std::string const& name, std::size_t components,
                       std::vector<Value> const& values) {
  std::uint64_t const size = values.size() * sizeof(Value);
  std::string bytes(reinterpret_cast<char const*>(&size), sizeof size);
  bytes.append(reinterpret_cast<char const*>(values.data()), size);
  return fmt::format(
      "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"binary\">\n{}\n</DataArray>\n", type, name,
      components, base64(bytes));
}

/// Joins two columns to vectors in the plane z = 0, which VTK requires to draw arrows.
std::string plane_vectors(std::string const& name, VectorColumn const& x, VectorColumn const& y) {
  std::vector<double> values;
  for (std::size_t i = 0; i < x.values.size(); ++i) values.insert(values.end(), {x.values[i], y.values[i], 0.0});
  return data_array("Float64", name, 3, values);
}

/// Returns the arrays at the points: vectors with their uncertainty, and the other quantities that are known.
std::string point_data(std::vector<VectorColumn> const& columns) {
  auto const vectors = [&](std::string const& name, std::string const& x, std::string const& y) {
    VectorColumn const& of_x = column_named(columns, x);
    VectorColumn const& of_y = column_named(columns, y);
    return of_x.is_known() || of_y.is_known() ? plane_vectors(name, of_x, of_y) : std::string();
  };
  std::string text = "<PointData Vectors=\"displacement_px\">\n";
  text += plane_vectors("displacement_px", column_named(columns, "u_px"), column_named(columns, "v_px"));
  text += vectors("sigma_px", "sigma_u_px", "sigma_v_px");
  text += vectors("raw_displacement_px", "u_raw_px", "v_raw_px");
  for (VectorColumn const& column : columns) {
    if (column.units == "px" || !column.is_known()) continue;
    if (column.is_code) {
      text +=
          data_array("Int32", column.name, 1, std::vector<std::int32_t>(column.values.begin(), column.values.end()));
    } else {
      text += data_array("Float64", column.name, 1, column.values);
    }
  }
  return text + "</PointData>\n";
}

/// Returns the file of one data set.
/// @param type     type of the data set, which is also the name of its element
/// @param element  attributes of that element, with a leading blank, or nothing
std::string vtk_file(std::string const& type, std::string const& element, std::string const& content) {
  constexpr char const* order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"{0}\" version=\"1.0\" byte_order=\"{1}\" header_type=\"UInt64\">\n"
      "<!-- gladstone vectors: positions and displacements in px, y and v downwards -->\n"
      "<{0}{2}>\n{3}</{0}>\n</VTKFile>\n",
      type, order, element, content);
}

/// Returns the spacing of coordinates.
/// @throws OutputError if they deviate from uniform ones by more than 0.01 px, within which positions count as equal
double uniform_spacing(std::vector<double> const& places, std::string const& path) {
  if (places.size() < 2) return 1.0;
  double const spacing = (places.back() - places.front()) / static_cast<double>(places.size() - 1);
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (std::abs(places.front() + static_cast<double>(i) * spacing - places[i]) <= 0.01) continue;
    throw OutputError(path, "requires vectors of uniform spacing (a VTK image has one spacing per axis); write .vtp");
  }
  return spacing;
}

}  // namespace

void write_vector_vti(std::string const& path, DisplacementField const& field, FileOrigin const& origin) {
  VectorGrid const grid = require_vector_grid(field, path, "a VTK image");
  std::string const extent = fmt::format("0 {} 0 {} 0 0", grid.x.size() - 1, grid.y.size() - 1);
  std::string const element =
      fmt::format(" WholeExtent=\"{}\" Origin=\"{:.17g} {:.17g} 0\" Spacing=\"{:.17g} {:.17g} 1\"", extent,
                  grid.x.front(), grid.y.front(), uniform_spacing(grid.x, path), uniform_spacing(grid.y, path));
  std::string const piece =
      fmt::format("<Piece Extent=\"{}\">\n{}</Piece>\n", extent, point_data(vector_columns(field)));
  write_vector_bytes(path, vtk_file("ImageData", element, piece), origin);
}

void write_vector_vtp(std::string const& path, DisplacementField const& field, FileOrigin const& origin) {
  std::vector<VectorColumn> const columns = vector_columns(field);
  std::vector<std::int64_t> points(field.size()), ends(field.size());
  for (std::size_t i = 0; i < field.size(); ++i) {
    points[i] = static_cast<std::int64_t>(i);
    ends[i] = points[i] + 1;
  }
  std::string piece = fmt::format("<Piece NumberOfPoints=\"{0}\" NumberOfVerts=\"{0}\">\n", field.size());
  piece += point_data(columns);
  piece += "<Points>\n" + plane_vectors("position_px", column_named(columns, "x_px"), column_named(columns, "y_px")) +
           "</Points>\n<Verts>\n" + data_array("Int64", "connectivity", 1, points) +
           data_array("Int64", "offsets", 1, ends) + "</Verts>\n</Piece>\n";
  write_vector_bytes(path, vtk_file("PolyData", "", piece), origin);
}

}  // namespace gladstone::detail
