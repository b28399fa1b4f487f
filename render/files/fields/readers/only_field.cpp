#include "render/files/fields/readers/only_field.h"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "render/base/error.h"
#include "render/base/nearest_name.h"
#include "render/files/fields/readers/array_axes.h"
#include "render/files/fields/readers/array_coordinates.h"

namespace gladstone::inline files {
namespace {

constexpr char const* own_density = "density_kg_m3";

/// Returns true if an axis of an array counts vector components according to its dimension scales: the scale of an axis
/// with two or three elements is not a coordinate, but that of another axis is.
bool has_components(ArrayFile const& file, std::string const& name, ArrayAxes const& axes) {
  auto const scales = file.dimension_scales(name);
  bool components = false, coordinates = false;
  for (std::size_t const axis : axes.spatial) {
    bool const coordinate = coordinate_name(scales[axis]).has_value();
    coordinates = coordinates || coordinate;
    components = components || (!scales[axis].empty() && !coordinate && may_be_components(axes.shape[axis]));
  }
  return components && coordinates;
}

}  // namespace

std::string only_field(ArrayFile const& file, std::string const& path, int values) {
  std::vector<std::string> volumes, planes;
  std::string others;
  for (auto const& name : file.names()) {
    ArrayShape const shape = file.shape(name);
    others += fmt::format("{}\"{}\" {}", others.empty() ? "" : ", ", name, shape_text(shape));
    auto const axes = find_axes(shape, values);
    if (!axes || coordinate_name(name) || has_components(file, name, *axes)) continue;
    if (axes->spatial.size() == 3) volumes.push_back(name);
    bool const wide =
        std::all_of(axes->spatial.begin(), axes->spatial.end(), [&shape](std::size_t axis) { return shape[axis] > 1; });
    if (axes->spatial.size() == 2 && wide) planes.push_back(name);
  }
  auto const& fields = volumes.empty() ? planes : volumes;
  if (fields.size() == 1) return fields.front();
  // several fields: prefer the density of gladstone's files, which also contain its uncertainty and truth
  if (std::find(fields.begin(), fields.end(), own_density) != fields.end()) return own_density;
  if (fields.empty()) {
    for (auto const& other : file.describe_others()) others += (others.empty() ? "" : ", ") + other;
    throw DataError(ErrorCode::missing_content, path,
                    fmt::format("has no {}; it has {}",
                                values == 1 ? "scalar field, [nz, ny, nx], [nz, ny, nx, 1] or [ny, nx]"
                                            : "velocity, [nz, ny, nx, 3] or arrays u, v and w of equal shape",
                                others.empty() ? "no numbers at all" : others));
  }
  throw DataError(ErrorCode::undetermined, path,
                  "has several fields; select one with dataset = " + quoted_list(fields));
}

}  // namespace gladstone::inline files
