#include "render/base/fields/readers/hdf5.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>

#include "render/base/error.h"
#include "render/base/hdf5_file.h"
#include "render/base/nearest_name.h"

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

/// Returns the axis and unit of a coordinate dataset from its name; nullopt for other names.
struct NamedCoordinate {
  char axis;
  std::string unit;
};
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

/// Returns the only dataset that can be the field, if the user names none.
/// @throws DataError if there is none, or several
std::string only_field(Hdf5Reader const& file, std::string const& path, int values) {
  std::vector<std::string> volumes, planes;
  std::string others;
  for (auto const& name : file.linked_number_datasets()) {
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
    throw DataError(path, fmt::format("has no {}; it has {}",
                                      values == 1 ? "scalar field, [nz, ny, nx], [nz, ny, nx, 1] or [ny, nx]"
                                                  : fmt::format("velocity, [nz, ny, nx, {}]", values),
                                      others.empty() ? "no numbers at all" : others));
  }
  throw DataError(path, "has several fields; say which with dataset = " + quoted_list(fields));
}

/// Coordinates of the nodes along one axis of an array.
struct Coordinates {
  std::string dataset;
  std::vector<double> places;
  std::string unit;
};

class Hdf5Source final : public CheckedSource {
 public:
  Hdf5Source(Hdf5Reader file, std::string const& path, std::string const& dataset, FieldWish const& wish)
      : CheckedSource(path, dataset, wish.values), file_(std::move(file)), shape_(file_.shape(name_)) {
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
    units_.values = trimmed(file_.attribute_of(name_, "units"));
    if (values_ == 1 && rank() == 3 && may_be_components(length(0)) && length(1) > 3 && length(2) > 3) {
      notes_.push_back(
          fmt::format("the last axis of \"{}\" of shape {} may be the components of a vector; it is taken as "
                      "one in space",
                      name_, shape_text(shape_)));
    }
    std::string const by = place_axes(wish.axes);
    describe(nodes, rank(), by);
    std::vector<double> first(1);
    file_.read_box(name_, Shape(shape_.size(), 0), Shape(shape_.size(), 1), first);  // reports a missing filter
  }

 private:
  std::size_t rank() const { return array_.spatial.size(); }
  /// Index in the array of a spatial axis, which is counted from the fastest.
  std::size_t number(std::size_t axis) const { return array_.spatial[rank() - 1 - axis]; }
  std::size_t length(std::size_t axis) const { return shape_[number(axis)]; }

  [[noreturn]] void refuse_shape() const {
    bool const in_front = shape_.size() == 4 && shape_[3] > 3 && may_be_components(shape_[0]);
    std::string const why = shape_.size() == 4
                                ? fmt::format("holds {} values a point", in_front ? shape_[0] : shape_[3])
                                : fmt::format("has rank {}", shape_.size());
    std::string const wanted = values_ == 1 ? "a scalar field has shape [nz, ny, nx], [nz, ny, nx, 1] or [ny, nx]"
                                            : fmt::format("a velocity has shape [nz, ny, nx, {}]", values_);
    throw DataError(path_, fmt::format("dataset \"{}\" of shape {} {}; {}", name_, shape_text(shape_), why, wanted));
  }

  /// Assigns world axes and coordinates to the stored axes. @return source of the assignment
  std::string place_axes(std::string const& wanted) {
    std::array<std::optional<Coordinates>, 3> of_axis;  // by stored axis, fastest first
    std::array<std::optional<Coordinates>, 3> of_letter;
    std::string order;
    auto const scales = file_.dimension_scales(name_);
    for (std::size_t i = 0; i < rank(); ++i) {
      std::string const& scale = scales[number(i)];
      if (scale.empty()) continue;
      auto const named = coordinate_name(scale);
      of_axis[i] = read_coordinates(scale, named ? named->unit : "");
      if (named) order.insert(order.begin(), named->axis);
    }
    std::string by = "by its dimension scales";
    if (order.size() != rank() || !is_axis_order(order)) {
      for (std::size_t letter = 0; letter < 3; ++letter) of_letter[letter] = find_coordinates("xyz"[letter]);
      if (wanted.empty()) order = order_by_lengths(of_letter, by);
    }
    if (!wanted.empty()) {
      order = wanted;
      by = "axes = \"" + wanted + '"';
    }
    name_axes(axes_, order, rank(), path_);
    for (std::size_t i = 0; i < 3; ++i) {
      auto& own = of_axis[i];
      if (!own) own = of_letter[static_cast<std::size_t>(axes_[i].world - 'x')];
      if (own && i < rank()) place(i, *own);
    }
    // A missing or single-node axis gets the spacing of the next faster axis.
    for (std::size_t i = 1; i < 3; ++i) {
      if (i >= rank() || length(i) == 1) axes_[i].step = std::abs(axes_[i - 1].step);
    }
    return by;
  }

  /// Sets the coordinates of a stored axis, converted to the unit of the first axis.
  void place(std::size_t i, Coordinates const& own) {
    std::string const what = "dataset \"" + own.dataset + '"';
    if (own.places.size() != length(i)) {
      throw DataError(path_, fmt::format("{} has {} coordinates for the {} nodes of \"{}\"; if its axes are in another "
                                         "order, name it: axes = \"zxy\"",
                                         what, own.places.size(), length(i), name_));
    }
    char const world = axes_[i].world;
    axes_[i] = axis_from_coordinates(own.places, path_, what);
    axes_[i].world = world;
    if (length(i) == 1) return;  // a single node has no spacing, and its unit is irrelevant
    double ratio = 1;
    if (units_.spaced) {
      auto const known = unit_ratio(own.unit, units_.length);
      if (!known) {
        throw DataError(path_, fmt::format("{} is in \"{}\" where other coordinates are in \"{}\"; give all axes units "
                                           "that are known here",
                                           what, own.unit, units_.length));
      }
      ratio = *known;
    } else {
      units_.spaced = true;
      units_.length = own.unit;
    }
    axes_[i].first *= ratio;
    axes_[i].step *= ratio;
    for (double& place : axes_[i].coordinates) place *= ratio;
  }

  std::optional<Coordinates> read_coordinates(std::string const& dataset, std::string const& unit) const {
    try {
      Shape const shape = file_.shape(dataset);
      auto const wide = std::count_if(shape.begin(), shape.end(), [](std::size_t size) { return size != 1; });
      // netCDF-4 marks dimensions without coordinates by this attribute
      bool const length_alone = file_.attribute_of(dataset, "NAME").starts_with("This is a netCDF dimension but not");
      if (shape.empty() || wide > 1 || length_alone) return std::nullopt;
      Coordinates found{last_step(dataset), file_.read(dataset), unit};
      if (found.places.empty()) return std::nullopt;
      if (unit.empty()) found.unit = trimmed(file_.attribute_of(dataset, "units"));
      return found;
    } catch (MemoryError const&) {
      throw;
    } catch (DataError const&) {  // not numeric
      return std::nullopt;
    }
  }

  /// Finds the coordinates along an axis: in the group of the array, else in the nearest group above it.
  std::optional<Coordinates> find_coordinates(char axis) const {
    for (std::size_t end = name_.rfind('/');; end = end == 0 ? std::string::npos : name_.rfind('/', end - 1)) {
      std::string const group = end == std::string::npos ? "" : name_.substr(0, end + 1);
      for (auto const& [suffix, unit] : coordinate_names) {
        for (char const letter : {axis, static_cast<char>(std::toupper(static_cast<unsigned char>(axis)))}) {
          std::string const dataset = group + letter + suffix;
          if (dataset == name_ || !file_.has(dataset)) continue;
          if (auto found = read_coordinates(dataset, unit)) return found;
        }
      }
      if (group.empty()) return std::nullopt;
    }
  }

  /// Determines the order of the axes, slowest first, by the lengths of the coordinates: z, y, x if they allow it, else
  /// the only order that they allow.
  /// @param by  receives the source of the order
  /// @throws DataError if several other orders are possible
  std::string order_by_lengths(std::array<std::optional<Coordinates>, 3> const& of_letter, std::string& by) {
    auto const fits = [&](std::string const& order) {
      for (std::size_t i = 0; i < rank(); ++i) {
        auto const& own = of_letter[static_cast<std::size_t>(order[rank() - 1 - i] - 'x')];
        if (own && own->places.size() != length(i)) return false;
      }
      return true;
    };
    std::string const usual = rank() == 2 ? "yx" : "zyx";
    std::vector<std::string> fitting;
    std::string order = rank() == 2 ? "xy" : "xyz";
    do {
      if (fits(order)) fitting.push_back(order);
    } while (std::next_permutation(order.begin(), order.end()));
    bool const some = std::any_of(of_letter.begin(), of_letter.end(), [](auto const& own) { return own.has_value(); });
    by = some && fitting.size() == 1 ? "by the lengths of its coordinates" : "the default order";
    if (fitting.empty() || fits(usual)) {
      bool const matlab = !file_.attribute_of(name_, "MATLAB_class").empty();
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

  int significant_bits() const override { return file_.significant_bits(name_); }

  void read_raw_rows(int plane, int first_row, int count, std::span<double> out) override {
    Shape start(shape_.size(), 0), size(shape_.size(), 1);
    size[number(0)] = length(0);
    start[number(1)] = static_cast<std::size_t>(first_row);
    size[number(1)] = static_cast<std::size_t>(count);
    if (rank() == 3) start[number(2)] = static_cast<std::size_t>(plane);
    if (!array_.component || *array_.component > 0) {
      if (array_.component) size[*array_.component] = static_cast<std::size_t>(values_);
      return file_.read_box(name_, start, size, out);
    }
    auto const width = static_cast<std::size_t>(values_);
    std::vector<double> component(out.size() / width);
    for (std::size_t i = 0; i < width; ++i) {
      start[0] = i;
      file_.read_box(name_, start, size, component);
      for (std::size_t node = 0; node < component.size(); ++node) out[node * width + i] = component[node];
    }
  }

  Hdf5Reader file_;
  Shape shape_;
  ArrayAxes array_;
};

}  // namespace

std::unique_ptr<CheckedSource> open_hdf5(std::string const& path, FieldWish const& wish) {
  Hdf5Reader file(path);
  std::string const name = wish.dataset.empty() ? only_field(file, path, wish.values) : wish.dataset;
  return std::make_unique<Hdf5Source>(std::move(file), path, name, wish);
}

}  // namespace gladstone
