#include "render/files/fields/readers/array_coordinates.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <limits>

#include "render/base/error.h"
#include "render/base/text.h"
#include "render/files/fields/readers/packing.h"

namespace gladstone::inline files {
namespace {

/// Suffix of the name of a coordinate dataset ("x_mm") and its unit; "" if the unit is an attribute.
struct CoordinateName {
  char const* suffix;
  char const* unit;
};
constexpr std::array coordinate_names{
    CoordinateName{"coor", ""}, CoordinateName{"", ""},      CoordinateName{"_coor", ""}, CoordinateName{"_mm", "mm"},
    CoordinateName{"_m", "m"},  CoordinateName{"_um", "um"}, CoordinateName{"_cm", "cm"}};

}  // namespace

std::string last_step(std::string const& path) { return path.substr(path.rfind('/') + 1); }

std::optional<NamedCoordinate> coordinate_name(std::string const& path) {
  std::string const name = last_step(path);
  if (name.empty()) return std::nullopt;
  char const axis = static_cast<char>(std::tolower(static_cast<unsigned char>(name.front())));
  if (axis < 'x' || axis > 'z') return std::nullopt;
  for (auto const& [suffix, unit] : coordinate_names) {
    if (name.substr(1) == suffix) return NamedCoordinate{axis, unit};
  }
  return std::nullopt;
}

std::optional<ArrayCoordinates> CoordinateReader::read(std::string const& dataset, std::string const& unit) const {
  ArrayShape shape;
  ArrayCoordinates found{last_step(dataset), {}, unit};
  try {
    shape = file_.shape(dataset);
    auto const wide = std::count_if(shape.begin(), shape.end(), [](std::size_t size) { return size != 1; });
    // netCDF-4 marks dimensions without coordinates by this attribute
    bool const length_alone = file_.attribute(dataset, "NAME").starts_with("This is a netCDF dimension but not");
    if (shape.empty() || length_alone || (wide > 1 && !is_mesh(shape))) return std::nullopt;
    found.places = file_.read(dataset);
    if (found.places.empty()) return std::nullopt;
    read_packing(file_, dataset).unpack(found.places);
    if (unit.empty()) found.unit = trimmed(file_.attribute(dataset, "units"));
    if (wide <= 1) return found;
  } catch (DataError const& error) {  // the dataset is not numeric
    if (error.code() == ErrorCode::memory) throw;
    return std::nullopt;
  }
  reduce_mesh(found, shape);
  return found;
}

bool CoordinateReader::is_mesh(ArrayShape shape) const {
  // the array is one of the datasets x, y and z, so that these are fields and not coordinates
  if (coordinate_name(name_)) return false;
  ArrayShape field;
  for (std::size_t i = axes_.rank(); i-- > 0;) field.push_back(axes_.length(i));
  std::erase(field, 1u);
  std::erase(shape, 1u);
  return shape == field;
}

void CoordinateReader::reduce_mesh(ArrayCoordinates& mesh, ArrayShape const& shape) const {
  std::vector<double> const all = std::move(mesh.places);
  std::array<std::size_t, 3> strides{};
  std::size_t stride = 1;
  mesh.places = {all.front()};
  for (std::size_t i = 0; i < axes_.rank(); stride *= axes_.length(i), ++i) {
    strides[i] = stride;
    std::vector<double> line;
    for (std::size_t k = 0; k < axes_.length(i); ++k) line.push_back(all[k * stride]);
    if (std::abs(line.back() - line.front()) <= std::abs(mesh.places.back() - mesh.places.front())) continue;
    mesh.places = std::move(line);
    mesh.axis = i;
  }
  // The tolerance is that of axis_from_coordinates().
  auto const [low, high] = std::minmax_element(mesh.places.begin(), mesh.places.end());
  double const step = (*high - *low) / static_cast<double>(std::max<std::size_t>(mesh.places.size(), 2) - 1);
  double const largest = std::max(std::abs(*low), std::abs(*high));
  double const tolerance = 1e-4 * step + 2.0 * std::numeric_limits<float>::epsilon() * largest;
  for (std::size_t node = 0; node < all.size(); ++node) {
    std::size_t const k = mesh.axis ? node / strides[*mesh.axis] % axes_.length(*mesh.axis) : 0;
    if (std::abs(all[node] - mesh.places[k]) <= tolerance || !std::isfinite(mesh.places[k])) continue;
    throw DataError(ErrorCode::unsupported, path_,
                    fmt::format("dataset \"{}\" of shape {} varies along several axes of \"{}\" (the grid is "
                                "curved, oblique or rotated); resample the field to a grid along x, y and z",
                                mesh.dataset, shape_text(shape), name_));
  }
}

std::optional<ArrayCoordinates> CoordinateReader::find(char axis) const {
  for (std::size_t end = name_.rfind('/');; end = end == 0 ? std::string::npos : name_.rfind('/', end - 1)) {
    std::string const group = end == std::string::npos ? "" : name_.substr(0, end + 1);
    for (auto const& [suffix, unit] : coordinate_names) {
      for (char const letter : {axis, static_cast<char>(std::toupper(static_cast<unsigned char>(axis)))}) {
        std::string const dataset = group + letter + suffix;
        if (dataset == name_ || !file_.has(dataset)) continue;
        if (auto found = read(dataset, unit)) return found;
      }
    }
    if (group.empty()) return std::nullopt;
  }
}

}  // namespace gladstone::inline files
