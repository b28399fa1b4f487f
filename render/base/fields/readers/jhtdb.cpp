#include "render/base/fields/readers/jhtdb.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "render/base/error.h"
#include "render/base/fields/readers/checked_source.h"
#include "render/base/hdf5_file.h"
#include "render/base/nearest_name.h"

namespace gladstone {
namespace {

using Shape = std::vector<std::size_t>;

std::string shape_text(Shape const& shape) { return fmt::format("[{}]", fmt::join(shape, ", ")); }

/// Whether a dataset has so many values at every node of a volume.
bool is_field(Shape const& shape, int values) {
  return (values == 1 && shape.size() == 3) || (shape.size() == 4 && shape[3] == static_cast<std::size_t>(values));
}

/// Shapes of such datasets, for messages.
std::string wanted_shape(int values) {
  return values == 1 ? "a scalar field has shape [nz, ny, nx] or [nz, ny, nx, 1]"
                     : fmt::format("a velocity has shape [nz, ny, nx, {}]", values);
}

/// The datasets of numbers in the file's root, with their shapes.
std::vector<std::pair<std::string, Shape>> numeric_datasets(Hdf5Reader const& file) {
  std::vector<std::pair<std::string, Shape>> found;
  for (auto const& name : file.dataset_names()) {
    try {
      found.emplace_back(name, file.shape(name));
    } catch (DataError const&) {  // texts and records beside the field
    }
  }
  return found;
}

std::string only_field(Hdf5Reader const& file, std::string const& path, int values) {
  auto const datasets = numeric_datasets(file);
  std::vector<std::string> fields;
  std::string others;
  for (auto const& [name, shape] : datasets) {
    if (is_field(shape, values)) fields.push_back(name);
    others += fmt::format("{}\"{}\" {}", others.empty() ? "" : ", ", name, shape_text(shape));
  }
  if (fields.size() == 1) return fields.front();
  if (fields.empty()) {
    throw DataError(path, fmt::format("has no {}; it has {}",
                                      values == 1 ? "scalar field, [nz, ny, nx] or [nz, ny, nx, 1]"
                                                  : fmt::format("velocity, [nz, ny, nx, {}]", values),
                                      others.empty() ? "no numbers at all" : others));
  }
  throw DataError(path, "has several fields; say which with dataset = " + quoted_list(fields));
}

/// Fits first + i step to the coordinates of an axis.
struct Axis {
  double first = 0.0;
  double step = 1.0;
};

Axis uniform_axis(std::vector<double> const& x, std::string const& path, std::string const& name) {
  auto const refuse = [&](std::string const& why) { throw DataError(path, "dataset \"" + name + "\": " + why); };
  double const step = (x.back() - x.front()) / static_cast<double>(x.size() - 1);
  double const largest = std::max(std::abs(x.front()), std::abs(x.back()));
  if (!std::isfinite(step)) refuse("coordinates are not finite");
  if (step <= 0.0)
    refuse(fmt::format("coordinates do not ascend (from {} to {}); turn the axis round", x.front(), x.back()));
  // Coordinates are floats, and rounded to decimals by the client: two units in the last place of the largest.
  double const tolerance = 1e-4 * step + 2.0 * std::numeric_limits<float>::epsilon() * largest;
  for (std::size_t i = 0; i < x.size(); ++i) {
    double const expected = x.front() + static_cast<double>(i) * step;
    if (std::abs(x[i] - expected) <= tolerance) continue;
    refuse(
        fmt::format("the axis is not uniform: node {} lies at {} where {:.9g} is expected; resample the field to a "
                    "uniform grid",
                    i, x[i], expected));
  }
  return {x.front(), step};
}

class JhtdbSource final : public CheckedSource {
 public:
  JhtdbSource(Hdf5Reader file, std::string const& path, std::string const& dataset, int values)
      : CheckedSource(path, dataset, values), file_(std::move(file)) {
    Shape const shape = file_.shape(name_);
    if (!is_field(shape, values)) {
      std::string const why = shape.size() == 4 ? fmt::format("holds {} values a point", shape[3])
                                                : fmt::format("has rank {}", shape.size());
      throw DataError(
          path_, fmt::format("dataset \"{}\" of shape {} {}; {}", name_, shape_text(shape), why, wanted_shape(values)));
    }
    for (std::size_t axis = 0; axis < 3; ++axis) {
      std::size_t const nodes = shape[2 - axis];
      if (nodes == 0 || nodes > static_cast<std::size_t>(std::numeric_limits<int>::max())) {
        throw DataError(path_, fmt::format("dataset \"{}\" has no usable size: {}", name_, shape_text(shape)));
      }
      grid_.nodes[axis] = static_cast<int>(nodes);
    }
    units_.values = file_.attribute_of(name_, "units");
    read_coordinates();
  }

 private:
  void read_coordinates() {
    std::array<Axis, 3> axes;
    std::array<char const*, 3> const names{"xcoor", "ycoor", "zcoor"};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (!file_.has(names[axis])) continue;
      if (axis == 0 || grid_.nodes[axis] > 1) read_unit(names[axis]);
      auto const coordinates = file_.read(names[axis]);
      std::size_t const nodes = static_cast<std::size_t>(grid_.nodes[axis]);
      if (coordinates.size() != nodes) {
        throw DataError(path_, fmt::format("dataset \"{}\" has {} coordinates for the {} nodes of \"{}\"", names[axis],
                                           coordinates.size(), nodes, name_));
      }
      axes[axis] = nodes > 1 ? uniform_axis(coordinates, path_, names[axis]) : Axis{coordinates[0], axes[0].step};
      if (!std::isfinite(axes[axis].first)) {
        throw DataError(path_, fmt::format("dataset \"{}\": coordinates are not finite", names[axis]));
      }
    }
    grid_.origin = {axes[0].first, axes[1].first, axes[2].first};
    grid_.spacing = {axes[0].step, axes[1].step, axes[2].step};
  }

  /// The unit of the coordinates, in the attribute "units" as netCDF has it.
  void read_unit(char const* axis) {
    std::string const unit = file_.attribute_of(axis, "units");
    if (units_.spaced && unit != units_.length) {
      throw DataError(
          path_, fmt::format("dataset \"{}\" is in \"{}\" where \"xcoor\" is in \"{}\"; give all axes one unit", axis,
                             unit, units_.length));
    }
    units_.spaced = true;
    units_.length = unit;
  }

  int significant_bits() const override { return file_.significant_bits(name_); }

  void read_raw_planes(int first_plane, int count, std::span<double> out) override {
    file_.read_rows(name_, static_cast<std::size_t>(first_plane), static_cast<std::size_t>(count), out);
  }

  void read_raw_rows(int plane, int first_row, int count, std::span<double> out) override {
    file_.read_rows_of(name_, static_cast<std::size_t>(plane), static_cast<std::size_t>(first_row),
                       static_cast<std::size_t>(count), out);
  }

  Hdf5Reader file_;
};

}  // namespace

std::unique_ptr<FieldSource> open_jhtdb(std::string const& path, std::string const& dataset, int values) {
  Hdf5Reader file(path);
  std::string const name = dataset.empty() ? only_field(file, path, values) : dataset;
  return std::make_unique<JhtdbSource>(std::move(file), path, name, values);
}

}  // namespace gladstone
