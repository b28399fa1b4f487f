#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <set>

#include "analysis/vectors/vector_writers/vector_columns.h"
#include "analysis/vectors/vector_writers/vector_writers.h"
#include "render/base/error.h"
#include "render/files/base64.h"

namespace gladstone::inline vectors {
namespace {

/// Returns a <DataArray> whose values are encoded in base64: the number of bytes, then the bytes.
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

std::string scalar_array(VectorColumn const& column) {
  if (!column.is_code) return data_array("Float64", column.name, 1, column.values);
  return data_array("Int32", column.name, 1, std::vector<std::int32_t>(column.values.begin(), column.values.end()));
}

/// Joins columns to vectors with three components, which VTK requires to draw arrows; a missing third component is 0.
std::string join_columns(std::vector<VectorColumn> const& columns, VtkVectors const& vectors) {
  std::vector<double> values;
  std::size_t const count = column_named(columns, vectors.components[0]).values.size();
  for (std::size_t i = 0; i < count; ++i)
    for (std::string const& name : vectors.components)
      values.push_back(name.empty() ? 0.0 : column_named(columns, name).values[i]);
  return data_array("Float64", vectors.name, 3, values);
}

bool is_known(std::vector<VectorColumn> const& columns, VtkVectors const& vectors) {
  return std::any_of(vectors.components.begin(), vectors.components.end(),
                     [&](std::string const& name) { return !name.empty() && column_named(columns, name).is_known(); });
}

/// Returns the element <PointData> with the arrays at the points: displacements, and all other vectors and scalars that
/// are known.
std::string point_data(std::vector<VectorColumn> const& columns, VtkLayout const& layout) {
  std::string text = fmt::format("<PointData Vectors=\"{}\">\n", layout.vectors.front().name);
  std::set<std::string> joined(layout.position.components.begin(), layout.position.components.end());
  for (VtkVectors const& vectors : layout.vectors) {
    joined.insert(vectors.components.begin(), vectors.components.end());
    bool const displacement = &vectors == &layout.vectors.front();
    if (displacement || is_known(columns, vectors)) text += join_columns(columns, vectors);
  }
  for (VectorColumn const& column : columns) {
    if (!joined.contains(column.name) && column.is_known()) text += scalar_array(column);
  }
  return text + "</PointData>\n";
}

/// Returns the text of a VTK file that contains one data set.
/// @param type     type of the data set, which is also the name of its element
/// @param element  attributes of the element, with a leading blank; may be empty
/// @param remark   what the file contains, with units and directions of the axes
std::string vtk_file(std::string const& type, std::string const& element, std::string const& content,
                     std::string const& remark) {
  constexpr char const* order = std::endian::native == std::endian::little ? "LittleEndian" : "BigEndian";
  return fmt::format(
      "<?xml version=\"1.0\"?>\n<VTKFile type=\"{0}\" version=\"1.0\" byte_order=\"{1}\" header_type=\"UInt64\">\n"
      "<!-- gladstone {4} -->\n"
      "<{0}{2}>\n{3}</{0}>\n</VTKFile>\n",
      type, order, element, content, remark);
}

/// Returns the uniform spacing of coordinates.
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

/// Returns true if the coordinates of all points are exactly those of their column or row in the image.
template <class Index>
bool is_exact(VectorTable const& table, std::string const& coordinate, double spacing, Index const& index_of) {
  std::vector<double> const& places = column_named(table.columns, coordinate).values;
  for (std::size_t i = 0; i < places.size(); ++i)
    if (places.front() + static_cast<double>(index_of(i)) * spacing != places[i]) return false;
  return true;
}

std::string vectors_remark(VectorTable const& table) {
  return "vectors: positions and displacements in " + table.remark;
}

/// Returns the columns that form the positions and vectors of a field with two components.
VtkLayout plane_layout() {
  return {{"position_px", {"x_px", "y_px", ""}},
          {{"displacement_px", {"u_px", "v_px", ""}},
           {"sigma_px", {"sigma_u_px", "sigma_v_px", ""}},
           {"raw_displacement_px", {"u_raw_px", "v_raw_px", ""}}}};
}

}  // namespace

void write_vti_table(std::string const& path, VectorTable const& table, VectorGrid const& grid, VtkLayout const& layout,
                     FileOrigin const& origin) {
  std::string const extent = fmt::format("0 {} 0 {} 0 0", grid.x.size() - 1, grid.y.size() - 1);
  double const dx = uniform_spacing(grid.x, path), dy = uniform_spacing(grid.y, path);
  std::string const element =
      fmt::format(" WholeExtent=\"{}\" Origin=\"{:.17g} {:.17g} 0\" Spacing=\"{:.17g} {:.17g} 1\"", extent,
                  grid.x.front(), grid.y.front(), dx, dy);
  bool const exact =
      is_exact(table, layout.position.components[0], dx, [&](std::size_t i) { return i % grid.x.size(); }) &&
      is_exact(table, layout.position.components[1], dy, [&](std::size_t i) { return i / grid.x.size(); });
  VtkLayout complete = layout;
  if (!exact) complete.vectors.push_back(layout.position);
  std::string const piece =
      fmt::format("<Piece Extent=\"{}\">\n{}</Piece>\n", extent, point_data(table.columns, complete));
  write_vector_bytes(path, vtk_file("ImageData", element, piece, vectors_remark(table)), origin);
}

void write_vti_scalars(std::string const& path, std::vector<VectorColumn> const& columns,
                       std::array<std::vector<double>, 3> const& places, std::string const& remark,
                       FileOrigin const& origin) {
  std::string extent, first, spacing;
  for (std::vector<double> const& axis : places) {
    std::string const blank = extent.empty() ? "" : " ";
    std::size_t const intervals = axis.size() - 1;
    double const step = intervals > 0 ? (axis.back() - axis.front()) / static_cast<double>(intervals) : 1.0;
    extent += fmt::format("{}0 {}", blank, intervals);
    first += fmt::format("{}{:.17g}", blank, axis.front());
    spacing += fmt::format("{}{:.17g}", blank, step);
  }
  std::string piece = fmt::format("<Piece Extent=\"{}\">\n<PointData Scalars=\"{}\">\n", extent, columns.front().name);
  for (VectorColumn const& column : columns) piece += scalar_array(column);
  piece += "</PointData>\n</Piece>\n";
  std::string const element = fmt::format(" WholeExtent=\"{}\" Origin=\"{}\" Spacing=\"{}\"", extent, first, spacing);
  write_vector_bytes(path, vtk_file("ImageData", element, piece, "density: lengths in " + remark), origin);
}

void write_vtp_table(std::string const& path, VectorTable const& table, VtkLayout const& layout,
                     FileOrigin const& origin) {
  std::vector<std::int64_t> points(table.rows()), ends(table.rows());
  for (std::size_t i = 0; i < points.size(); ++i) {
    points[i] = static_cast<std::int64_t>(i);
    ends[i] = points[i] + 1;
  }
  std::string piece = fmt::format("<Piece NumberOfPoints=\"{0}\" NumberOfVerts=\"{0}\">\n", table.rows());
  piece += point_data(table.columns, layout);
  piece += "<Points>\n" + join_columns(table.columns, layout.position) + "</Points>\n<Verts>\n" +
           data_array("Int64", "connectivity", 1, points) + data_array("Int64", "offsets", 1, ends) +
           "</Verts>\n</Piece>\n";
  write_vector_bytes(path, vtk_file("PolyData", "", piece, vectors_remark(table)), origin);
}

void write_vector_vti(std::string const& path, DisplacementField const& field, FileOrigin const& origin) {
  VectorGrid const grid = require_vector_grid(field, path, "a VTK image");
  write_vti_table(path, vector_table(field), grid, plane_layout(), origin);
}

void write_vector_vtp(std::string const& path, DisplacementField const& field, FileOrigin const& origin) {
  write_vtp_table(path, vector_table(field), plane_layout(), origin);
}

}  // namespace gladstone::inline vectors
