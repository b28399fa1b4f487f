#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "render/base/error.h"
#include "render/base/nearest_name.h"
#include "render/base/text.h"
#include "render/files/fields/readers/array_file.h"
#include "render/files/fields/readers/packing.h"

namespace gladstone {
namespace {

using Shape = std::vector<std::size_t>;

std::string shape_text(Shape const& shape) { return fmt::format("[{}]", fmt::join(shape, ", ")); }

/// Roles of the axes of an array.
struct ArrayAxes {
  Shape spatial;                         ///< indices of the two or three spatial axes, slowest first
  std::optional<std::size_t> component;  ///< index of the axis of velocity components
};

/// Returns true if an axis has the length of two- or three-component vectors.
bool may_be_components(std::size_t size) { return size == 2 || size == 3; }

/// Determines the axes of an array with `values` numbers per node; nullopt if the shape is not a field.
std::optional<ArrayAxes> find_axes(Shape const& shape, int values) {
  ArrayAxes axes;
  for (std::size_t axis = 0; axis < shape.size(); ++axis) axes.spatial.push_back(axis);
  if (values > 1) {
    auto const count = static_cast<std::size_t>(values);
    if (shape.size() < 3 || (shape.back() != count && shape.front() != count)) return std::nullopt;
    axes.component = shape.back() == count ? shape.size() - 1 : 0;
    std::erase(axes.spatial, *axes.component);
  } else if (shape.size() > 3 &&
             (may_be_components(shape.back()) || (may_be_components(shape.front()) && shape.back() != 1))) {
    return std::nullopt;  // components of a vector, not an axis of two or three nodes
  }
  // Drop axes of length one until three remain: the last (one value per node) first, then from the front (one time).
  while (axes.spatial.size() > 3) {
    auto const single = [&shape](std::size_t axis) { return shape[axis] == 1; };
    auto const found = single(axes.spatial.back()) ? axes.spatial.end() - 1
                                                   : std::find_if(axes.spatial.begin(), axes.spatial.end(), single);
    if (found == axes.spatial.end()) return std::nullopt;
    axes.spatial.erase(found);
  }
  if (axes.spatial.size() < 2) return std::nullopt;
  return axes;
}

/// Suffix of the name of a coordinate dataset ("x_mm") and its unit; "" if the unit is an attribute.
struct CoordinateName {
  char const* suffix;
  char const* unit;
};
constexpr std::array coordinate_names{
    CoordinateName{"coor", ""}, CoordinateName{"", ""},      CoordinateName{"_coor", ""}, CoordinateName{"_mm", "mm"},
    CoordinateName{"_m", "m"},  CoordinateName{"_um", "um"}, CoordinateName{"_cm", "cm"}};

std::string last_step(std::string const& path) { return path.substr(path.rfind('/') + 1); }

/// Returns the only dataset that can be the field, for use if the user names none.
/// @throws DataError if there is none, or several
std::string only_field(ArrayFile const& file, std::string const& path, int values) {
  std::vector<std::string> volumes, planes;
  std::string others;
  for (auto const& name : file.names()) {
    Shape const shape = file.shape(name);
    others += fmt::format("{}\"{}\" {}", others.empty() ? "" : ", ", name, shape_text(shape));
    auto const axes = find_axes(shape, values);
    if (!axes || coordinate_name(name)) continue;
    if (axes->spatial.size() == 3) volumes.push_back(name);
    bool const wide =
        std::all_of(axes->spatial.begin(), axes->spatial.end(), [&shape](std::size_t axis) { return shape[axis] > 1; });
    if (axes->spatial.size() == 2 && wide) planes.push_back(name);
  }
  auto const& fields = volumes.empty() ? planes : volumes;
  if (fields.size() == 1) return fields.front();
  if (fields.empty()) {
    for (auto const& other : file.describe_others()) others += (others.empty() ? "" : ", ") + other;
    throw DataError(path, fmt::format("has no {}; it has {}",
                                      values == 1 ? "scalar field, [nz, ny, nx], [nz, ny, nx, 1] or [ny, nx]"
                                                  : fmt::format("velocity, [nz, ny, nx, {}]", values),
                                      others.empty() ? "no numbers at all" : others));
  }
  throw DataError(path, "has several fields; select one with dataset = " + quoted_list(fields));
}

/// Coordinates of the nodes along one axis of an array.
struct Coordinates {
  std::string dataset;
  std::vector<double> places;
  std::string unit;
  std::optional<std::size_t> axis = {};  ///< axis of the array, counted from the fastest, if the dataset determines it
};

class ArraySource final : public CheckedSource {
 public:
  ArraySource(std::unique_ptr<ArrayFile const> file, std::string const& path, std::string const& dataset,
              FieldSelection const& selection)
      : CheckedSource(path, dataset, selection.values), file_(std::move(file)), shape_(file_->shape(name_)) {
    auto const found = find_axes(shape_, values_);
    if (!found) refuse_shape();
    array_ = *found;
    std::array<int, 3> nodes{1, 1, 1};
    for (std::size_t i = 0; i < rank(); ++i) {
      std::size_t const size = length(i);
      if (size == 0 || size > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
        throw DataError(path_, fmt::format("dataset \"{}\" has no usable size: {}", name_, shape_text(shape_)));
      }
      nodes[i] = static_cast<int>(size);
    }
    notes_ = file_->notes();
    units_.values = trimmed(file_->attribute(name_, "units"));
    packing_ = read_packing(*file_, name_);
    if (values_ == 1 && rank() == 3 && may_be_components(length(0)) && length(1) > 3 && length(2) > 3) {
      notes_.push_back(
          fmt::format("the last axis of \"{}\" of shape {} may be the components of a vector; it is taken as "
                      "one in space",
                      name_, shape_text(shape_)));
    }
    std::string const by = place_axes(selection.axes);
    describe(nodes, rank(), by);
    if (cells_) reading_.by += "; data of cells, at their centres";
    std::vector<double> first(1);
    // reading one value reports a missing filter
    file_->read_box(name_, Shape(shape_.size(), 0), Shape(shape_.size(), 1), first);
  }

 private:
  std::size_t rank() const { return array_.spatial.size(); }
  /// Index in the array of a spatial axis, which is counted from the fastest.
  std::size_t number(std::size_t axis) const { return array_.spatial[rank() - 1 - axis]; }
  std::size_t length(std::size_t axis) const { return shape_[number(axis)]; }

  [[noreturn]] void refuse_shape() const {
    bool const in_front = shape_.size() == 4 && shape_[3] > 3 && may_be_components(shape_[0]);
    std::string const why = shape_.size() == 4
                                ? fmt::format("has {} values per point", in_front ? shape_[0] : shape_[3])
                                : fmt::format("has rank {}", shape_.size());
    std::string const wanted = values_ == 1 ? "a scalar field has shape [nz, ny, nx], [nz, ny, nx, 1] or [ny, nx]"
                                            : fmt::format("a velocity has shape [nz, ny, nx, {}]", values_);
    throw DataError(path_, fmt::format("dataset \"{}\" of shape {} {}; {}", name_, shape_text(shape_), why, wanted));
  }

  /// Assigns world axes and coordinates to the stored axes. @return source of the assignment
  std::string place_axes(std::string const& wanted) {
    std::array<std::optional<Coordinates>, 3> own;  // coordinates of each stored axis, fastest first
    std::array<std::optional<Coordinates>, 3> of_letter;
    std::string order;
    auto const scales = file_->dimension_scales(name_);
    for (std::size_t i = 0; i < rank(); ++i) {
      std::string const& scale = scales[number(i)];
      if (scale.empty()) continue;
      auto const named = coordinate_name(scale);
      own[i] = read_coordinates(scale, named ? named->unit : "");
      if (named) order.insert(order.begin(), named->axis);
    }
    std::string by = "by its dimension scales";
    if (order.size() != rank() || !is_axis_order(order)) {
      for (std::size_t letter = 0; letter < 3; ++letter) of_letter[letter] = find_coordinates("xyz"[letter]);
      order = order_by_labels();
      by = "by its dimension labels";
      if (wanted.empty() && order.empty()) order = order_by_lengths(of_letter, by);
    }
    if (!wanted.empty()) {
      order = wanted;
      by = "axes = \"" + wanted + '"';
    }
    name_axes(axes_, order, rank(), path_);
    for (std::size_t i = 0; i < rank(); ++i) {
      if (!own[i]) own[i] = of_letter[static_cast<std::size_t>(axes_[i].world - 'x')];
    }
    centre_edges(own);
    std::array<std::optional<std::string>, 3> unit_of;
    for (std::size_t i = 0; i < rank(); ++i) {
      if (!own[i]) continue;
      place(i, *own[i]);
      if (length(i) > 1) unit_of[i] = own[i]->unit;  // a single node has no spacing, and its unit is irrelevant
      units_.spaced = units_.spaced || length(i) > 1;
    }
    convert_lengths(axes_, unit_of, units_, notes_);
    report_missing(own);
    // A missing or single-node axis gets the spacing of the next faster axis.
    for (std::size_t i = 1; i < 3; ++i) {
      if (i >= rank() || length(i) == 1) axes_[i].step = std::abs(axes_[i - 1].step);
    }
    return by;
  }

  /// If each axis has one more coordinate than nodes, takes the coordinates as those of cell edges and replaces them by
  /// the cell centres.
  void centre_edges(std::array<std::optional<Coordinates>, 3>& own) {
    for (std::size_t i = 0; i < rank(); ++i) {
      if (length(i) == 1 && (!own[i] || own[i]->places.size() == 1)) continue;
      if (!own[i] || own[i]->places.size() != length(i) + 1) return;
    }
    cells_ = std::any_of(own.begin(), own.end(), [](auto const& one) { return one && one->places.size() > 1; });
    for (auto& coordinates : own) {
      if (!coordinates || coordinates->places.size() < 2) continue;
      auto& places = coordinates->places;
      for (std::size_t k = 0; k + 1 < places.size(); ++k) places[k] = 0.5 * (places[k] + places[k + 1]);
      places.pop_back();
    }
  }

  /// Sets the coordinates of a stored axis, in their own unit.
  void place(std::size_t i, Coordinates const& own) {
    std::string const what = "dataset \"" + own.dataset + '"';
    if (own.axis && *own.axis != i) {
      throw DataError(path_,
                      fmt::format("{} varies along axis {} of \"{}\" (from the slowest), where {} is axis {}; name "
                                  "the axes in the order of the file: axes = \"zxy\"",
                                  what, rank() - *own.axis, name_, axes_[i].world, rank() - i));
    }
    if (own.places.size() != length(i)) {
      throw DataError(path_, fmt::format("{} has {} coordinates for the {} nodes of \"{}\"; if its axes are in another "
                                         "order, name it: axes = \"zxy\"",
                                         what, own.places.size(), length(i), name_));
    }
    char const world = axes_[i].world;
    axes_[i] = axis_from_coordinates(own.places, path_, what);
    axes_[i].world = world;
  }

  /// Reports axes without coordinates, and the datasets that may be theirs but are not used.
  void report_missing(std::array<std::optional<Coordinates>, 3> const& own) {
    std::string missing;
    for (std::size_t i = rank(); i-- > 0;) {
      if (own[i] || length(i) == 1) continue;
      missing += (missing.empty() ? "" : ", ") + std::string(1, axes_[i].world);
    }
    if (missing.empty()) return;
    std::vector<std::string> unused;
    for (std::string const& dataset : file_->names()) {
      bool const used = std::any_of(own.begin(), own.end(),
                                    [&dataset](auto const& one) { return one && one->dataset == last_step(dataset); });
      if (used || dataset == name_ || last_step(dataset).starts_with('_')) continue;
      Shape const shape = file_->shape(dataset);
      std::size_t const size = std::accumulate(shape.begin(), shape.end(), std::size_t{1}, std::multiplies<>());
      bool fits = coordinate_name(dataset) && size > 1;
      for (std::size_t i = 0; i < rank(); ++i) {
        bool const line = std::find(shape.begin(), shape.end(), size) != shape.end();
        fits = fits || (line && size > 1 && (size == length(i) || size == length(i) + 1));
      }
      if (fits) unused.push_back(fmt::format("\"{}\" {}", dataset, shape_text(shape)));
    }
    std::string const ignored =
        unused.empty() ? ""
                       : fmt::format(
                             "; {} may be coordinates, but {} not used (known are datasets such as x, xcoor and "
                             "x_mm, of one axis or of the shape of the field)",
                             fmt::join(unused, ", "), unused.size() == 1 ? "it is" : "they are");
    bool const some = units_.spaced;
    if (!some && unused.empty()) return;  // FieldUnits::assumed() reports this
    notes_.push_back(fmt::format(
        "no coordinates along {} are found{}{}", missing,
        some ? fmt::format(", and nodes there are taken 1 {} apart", units_.length.empty() ? "mm" : units_.length) : "",
        ignored));
  }

  std::optional<Coordinates> read_coordinates(std::string const& dataset, std::string const& unit) const {
    Shape shape;
    Coordinates found{last_step(dataset), {}, unit};
    try {
      shape = file_->shape(dataset);
      auto const wide = std::count_if(shape.begin(), shape.end(), [](std::size_t size) { return size != 1; });
      // netCDF-4 marks dimensions without coordinates by this attribute
      bool const length_alone = file_->attribute(dataset, "NAME").starts_with("This is a netCDF dimension but not");
      if (shape.empty() || length_alone || (wide > 1 && !is_mesh(shape))) return std::nullopt;
      found.places = file_->read(dataset);
      if (found.places.empty()) return std::nullopt;
      read_packing(*file_, dataset).unpack(found.places);
      if (unit.empty()) found.unit = trimmed(file_->attribute(dataset, "units"));
      if (wide <= 1) return found;
    } catch (MemoryError const&) {
      throw;
    } catch (DataError const&) {  // the dataset is not numeric
      return std::nullopt;
    }
    reduce_mesh(found, shape);
    return found;
  }

  /// Returns true if an array of coordinates has the shape of the field, apart from axes of length one.
  bool is_mesh(Shape shape) const {
    if (coordinate_name(name_)) return false;  // the datasets x, y and z are then fields themselves
    Shape field;
    for (std::size_t i = rank(); i-- > 0;) field.push_back(length(i));
    std::erase(field, 1u);
    std::erase(shape, 1u);
    return shape == field;
  }

  /// Reduces coordinates of all nodes (a mesh grid) to those along the only axis on which they depend.
  /// @throws DataError if they vary along several axes
  void reduce_mesh(Coordinates& mesh, Shape const& shape) const {
    std::vector<double> const all = std::move(mesh.places);
    std::array<std::size_t, 3> strides{};
    std::size_t stride = 1;
    mesh.places = {all.front()};
    for (std::size_t i = 0; i < rank(); stride *= length(i), ++i) {
      strides[i] = stride;
      std::vector<double> line;
      for (std::size_t k = 0; k < length(i); ++k) line.push_back(all[k * stride]);
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
      std::size_t const k = mesh.axis ? node / strides[*mesh.axis] % length(*mesh.axis) : 0;
      if (std::abs(all[node] - mesh.places[k]) <= tolerance || !std::isfinite(mesh.places[k])) continue;
      throw DataError(path_, fmt::format("dataset \"{}\" of shape {} varies along several axes of \"{}\" (the grid is "
                                         "curved, oblique or rotated); resample the field to a grid along x, y and z",
                                         mesh.dataset, shape_text(shape), name_));
    }
  }

  /// Finds the coordinates along an axis: in the group of the array, else in the nearest group above it.
  std::optional<Coordinates> find_coordinates(char axis) const {
    for (std::size_t end = name_.rfind('/');; end = end == 0 ? std::string::npos : name_.rfind('/', end - 1)) {
      std::string const group = end == std::string::npos ? "" : name_.substr(0, end + 1);
      for (auto const& [suffix, unit] : coordinate_names) {
        for (char const letter : {axis, static_cast<char>(std::toupper(static_cast<unsigned char>(axis)))}) {
          std::string const dataset = group + letter + suffix;
          if (dataset == name_ || !file_->has(dataset)) continue;
          if (auto found = read_coordinates(dataset, unit)) return found;
        }
      }
      if (group.empty()) return std::nullopt;
    }
  }

  /// Returns the order of the axes, slowest first, by their labels x, y and z; empty if not all axes have one.
  std::string order_by_labels() const {
    auto const labels = file_->dimension_labels(name_);
    std::string order;
    for (std::size_t const axis : array_.spatial) {
      if (auto const named = coordinate_name(trimmed(labels[axis]))) order += named->axis;
    }
    return order.size() == rank() && is_axis_order(order) ? order : "";
  }

  /// Returns the orders of some axes in which each coordinate dataset has as many places as its axis has nodes, or
  /// `more` than that.
  std::vector<std::string> fitting_orders(std::string letters,
                                          std::array<std::optional<Coordinates>, 3> const& of_letter,
                                          std::size_t more) const {
    std::vector<std::string> fitting;
    do {
      bool fits = true;
      for (std::size_t i = 0; i < rank(); ++i) {
        auto const& own = of_letter[static_cast<std::size_t>(letters[rank() - 1 - i] - 'x')];
        if (!own) {
          fits = fits && (more == 0 || length(i) == 1);
          continue;
        }
        bool const single = length(i) == 1 && own->places.size() == 1;
        fits = fits && (own->places.size() == length(i) + more || single) && own->axis.value_or(i) == i;
      }
      if (fits) fitting.push_back(letters);
    } while (std::next_permutation(letters.begin(), letters.end()));
    return fitting;
  }

  /// Determines the order of the axes, slowest first, by the lengths of the coordinates: z, y, x if they allow it, else
  /// the only order that they allow. A plane is across x and y unless one of them has no coordinates and z has.
  /// @param by  receives the source of the order
  /// @throws DataError if several other orders are possible
  std::string order_by_lengths(std::array<std::optional<Coordinates>, 3> const& of_letter, std::string& by) {
    auto const wide = [&of_letter](char letter) {
      auto const& own = of_letter[static_cast<std::size_t>(letter - 'x')];
      return own && own->places.size() > 1;
    };
    std::string letters = "xyz";
    if (rank() == 2) letters = !wide('z') || (wide('x') && wide('y')) ? "xy" : wide('y') ? "yz" : "xz";
    std::string const usual(letters.rbegin(), letters.rend());
    std::vector<std::string> fitting = fitting_orders(letters, of_letter, 0);
    if (fitting.empty()) fitting = fitting_orders(letters, of_letter, 1);  // n + 1 coordinates: edges of cells
    bool some = false, meshes = false;
    for (auto const& own : of_letter) {
      some = some || own;
      meshes = meshes || (own && own->axis);
    }
    by = !some || fitting.size() != 1 ? "the default order"
         : meshes                     ? "by its coordinates"
                                      : "by the lengths of its coordinates";
    if (fitting.empty() || std::find(fitting.begin(), fitting.end(), usual) != fitting.end()) {
      bool const matlab = !file_->attribute(name_, "MATLAB_class").empty();
      if (matlab && fitting.size() > 1 && rank() == 3) {
        notes_.push_back(
            fmt::format("\"{}\" is an array of MATLAB of shape {}, taken as z, y, x (as ndgrid makes it); "
                        "if meshgrid made it, set axes = \"zxy\"",
                        name_, shape_text(shape_)));
      }
      return usual;
    }
    if (fitting.size() > 1) {
      throw DataError(path_, fmt::format("the coordinates of \"{}\" of shape {} allow several orders of its axes; name "
                                         "the right one: axes = {}",
                                         name_, shape_text(shape_), quoted_list(fitting)));
    }
    return fitting.front();
  }

  int significant_bits() const override {
    return packing_.scaled() ? std::numeric_limits<double>::digits : file_->significant_bits(name_);
  }

  void read_raw_rows(int plane, int first_row, int count, std::span<double> out) override {
    read_stored_rows(plane, first_row, count, out);
    if (packing_.scaled() || !packing_.missing.empty()) packing_.unpack(out);
  }

  void read_stored_rows(int plane, int first_row, int count, std::span<double> out) {
    Shape start(shape_.size(), 0), size(shape_.size(), 1);
    size[number(0)] = length(0);
    start[number(1)] = static_cast<std::size_t>(first_row);
    size[number(1)] = static_cast<std::size_t>(count);
    if (rank() == 3) start[number(2)] = static_cast<std::size_t>(plane);
    if (!array_.component || *array_.component > 0) {
      if (array_.component) size[*array_.component] = static_cast<std::size_t>(values_);
      return file_->read_box(name_, start, size, out);
    }
    auto const width = static_cast<std::size_t>(values_);
    std::vector<double> component(out.size() / width);
    for (std::size_t i = 0; i < width; ++i) {
      start[0] = i;
      file_->read_box(name_, start, size, component);
      for (std::size_t node = 0; node < component.size(); ++node) out[node * width + i] = component[node];
    }
  }

  std::unique_ptr<ArrayFile const> file_;
  Shape shape_;
  ArrayAxes array_;
  Packing packing_;
  bool cells_ = false;  ///< the coordinates are those of the edges of cells
};

}  // namespace

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

std::unique_ptr<CheckedSource> open_array_field(std::unique_ptr<ArrayFile const> file, std::string const& path,
                                                FieldSelection const& selection) {
  std::string const name = selection.dataset.empty() ? only_field(*file, path, selection.values) : selection.dataset;
  return std::make_unique<ArraySource>(std::move(file), path, name, selection);
}

}  // namespace gladstone
