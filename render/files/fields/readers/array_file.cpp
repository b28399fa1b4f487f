#include "render/files/fields/readers/array_file.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <optional>

#include "render/base/error.h"
#include "render/base/text.h"
#include "render/files/fields/readers/array_axes.h"
#include "render/files/fields/readers/array_coordinates.h"
#include "render/files/fields/readers/array_order.h"
#include "render/files/fields/readers/only_field.h"
#include "render/files/fields/readers/packing.h"
#include "render/files/fields/readers/velocity_arrays.h"

namespace gladstone::inline files {
namespace {

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
        throw DataError(ErrorCode::wrong_shape, path_,
                        fmt::format("dataset \"{}\" has no usable size: {}", name_, shape_text(shape_)));
      }
      nodes[i] = static_cast<int>(size);
    }
    notes_ = file_->notes();
    units_.values = trimmed(file_->attribute(name_, "units"));
    std::string const suffix(unit_suffix(name_).unit);
    if (!states_unit(units_.values) && !suffix.empty()) units_.values = suffix;
    packing_ = read_packing(*file_, name_);
    if (values_ == 1 && rank() == 3 && may_be_components(length(0)) && length(1) > 3 && length(2) > 3) {
      notes_.push_back({WarningCode::assumed, "",
                        fmt::format("the last axis of \"{}\" of shape {} is read as the axis x; if it contains the "
                                    "components of a vector, write each component as a separate array",
                                    name_, shape_text(shape_))});
    }
    std::string const by = place_axes(selection.axes);
    describe(nodes, rank(), by);
    if (cells_) reading_.by += "; data of cells, at their centres";
    std::vector<double> first(1);
    // reading one value reports a missing filter
    file_->read_box(name_, ArrayShape(shape_.size(), 0), ArrayShape(shape_.size(), 1), first);
  }

 private:
  std::size_t rank() const { return array_.rank(); }
  std::size_t number(std::size_t axis) const { return array_.number(axis); }
  std::size_t length(std::size_t axis) const { return array_.length(axis); }

  [[noreturn]] void refuse_shape() const {
    bool const in_front = shape_.size() == 4 && shape_[3] > 3 && may_be_components(shape_[0]);
    std::string const why = shape_.size() == 4
                                ? fmt::format("has {} values per point", in_front ? shape_[0] : shape_[3])
                                : fmt::format("has rank {}", shape_.size());
    std::string const wanted = values_ == 1 ? "a scalar field has shape [nz, ny, nx], [nz, ny, nx, 1] or [ny, nx]"
                                            : fmt::format("a velocity has shape [nz, ny, nx, {}]", values_);
    throw DataError(ErrorCode::wrong_shape, path_,
                    fmt::format("dataset \"{}\" of shape {} {}; {}", name_, shape_text(shape_), why, wanted));
  }

  /// Assigns world axes and coordinates to the stored axes. @return source of the assignment
  std::string place_axes(std::string const& wanted) {
    std::array<std::optional<ArrayCoordinates>, 3> own;  // coordinates of each stored axis, fastest first
    std::array<std::optional<ArrayCoordinates>, 3> of_letter;
    std::string order;
    CoordinateReader const reader(*file_, path_, name_, array_);
    auto const scales = file_->dimension_scales(name_);
    for (std::size_t i = 0; i < rank(); ++i) {
      std::string const& scale = scales[number(i)];
      if (scale.empty()) continue;
      auto const named = coordinate_name(scale);
      own[i] = reader.read(scale, named ? named->unit : "");
      if (named) order.insert(order.begin(), named->axis);
    }
    std::string by = "by its dimension scales";
    if (order.size() != rank() || !is_axis_order(order)) {
      for (std::size_t letter = 0; letter < 3; ++letter) of_letter[letter] = reader.find("xyz"[letter]);
      order = order_by_labels();
      by = "by its dimension labels";
      if (wanted.empty() && order.empty()) {
        ArrayOrder const found = order_by_lengths(of_letter, array_, path_, name_);
        if (found.several) note_matlab();
        order = found.letters;
        by = found.by;
      }
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
  void centre_edges(std::array<std::optional<ArrayCoordinates>, 3>& own) {
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
  void place(std::size_t i, ArrayCoordinates const& own) {
    std::string const what = "dataset \"" + own.dataset + '"';
    if (own.axis && *own.axis != i) {
      throw DataError(
          ErrorCode::inconsistent, path_,
          fmt::format("{} varies along axis {} of \"{}\" (counted from the slowest), but {} is read as axis {}; name "
                      "the axes in the order of the file: axes = \"zxy\"",
                      what, rank() - *own.axis, name_, axes_[i].world, rank() - i));
    }
    if (own.places.size() != length(i)) {
      throw DataError(ErrorCode::wrong_shape, path_,
                      fmt::format("{} has {} coordinates for the {} nodes of \"{}\"; if its axes are in another "
                                  "order, name it: axes = \"zxy\"",
                                  what, own.places.size(), length(i), name_));
    }
    char const world = axes_[i].world;
    axes_[i] = axis_from_coordinates(own.places, path_, what);
    axes_[i].world = world;
  }

  /// Reports axes without coordinates, and unused datasets that may contain the missing coordinates.
  void report_missing(std::array<std::optional<ArrayCoordinates>, 3> const& own) {
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
      ArrayShape const shape = file_->shape(dataset);
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
    notes_.push_back({WarningCode::assumed, "",
                      fmt::format("no coordinates along {} are found{}{}", missing,
                                  some ? fmt::format(", and nodes there are taken 1 {} apart",
                                                     units_.length.empty() ? "mm" : units_.length)
                                       : "",
                                  ignored)});
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

  /// Notes that the order of the axes of an array of MATLAB depends on how it was made.
  void note_matlab() {
    bool const matlab = !file_->attribute(name_, "MATLAB_class").empty();
    if (!matlab || rank() != 3) return;
    notes_.push_back({WarningCode::assumed, "",
                      fmt::format("\"{}\" is an array of MATLAB of shape {}, taken as z, y, x (as ndgrid makes it); if "
                                  "meshgrid made it, set axes = \"zxy\"",
                                  name_, shape_text(shape_))});
  }

  int significant_bits() const override {
    return packing_.scaled() ? std::numeric_limits<double>::digits : file_->significant_bits(name_);
  }

  void read_raw_rows(int plane, int first_row, int count, std::span<double> out) override {
    read_stored_rows(plane, first_row, count, out);
    if (packing_.scaled() || !packing_.missing.empty()) packing_.unpack(out);
  }

  void read_stored_rows(int plane, int first_row, int count, std::span<double> out) {
    ArrayShape start(shape_.size(), 0), size(shape_.size(), 1);
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
  ArrayShape shape_;
  ArrayAxes array_;
  Packing packing_;
  bool cells_ = false;  ///< the coordinates are those of the edges of cells
};

}  // namespace

std::unique_ptr<CheckedSource> open_array_field(std::unique_ptr<ArrayFile const> file, std::string const& path,
                                                FieldSelection const& selection) {
  if (selection.values == 3) file = join_velocities(std::move(file), path);
  std::string const name = selection.dataset.empty() ? only_field(*file, path, selection.values) : selection.dataset;
  return std::make_unique<ArraySource>(std::move(file), path, name, selection);
}

}  // namespace gladstone::inline files
