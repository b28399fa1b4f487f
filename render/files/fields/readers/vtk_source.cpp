#include "render/files/fields/readers/vtk_source.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "render/base/error.h"
#include "render/base/nearest_name.h"

namespace gladstone::inline files {
namespace {

/// Returns the axes of an image from its Direction matrix, whose columns are the directions of i, j and k.
StoredAxes image_axes(VtkGrid const& grid, VtkPlace place, std::string const& path) {
  StoredAxes axes;
  std::string taken;
  for (std::size_t column = 0; column < 3; ++column) {
    auto const along = [&](std::size_t row) { return grid.direction[3 * row + column]; };
    std::size_t largest = 0;
    for (std::size_t row = 1; row < 3; ++row) {
      if (std::abs(along(row)) > std::abs(along(largest))) largest = row;
    }
    for (std::size_t row = 0; row < 3; ++row) {
      constexpr double rounding = 1e-6;  // tolerance of angles [rad]: a millionth of the width of the field
      if (std::isfinite(along(row)) && (row == largest || std::abs(along(row)) <= rounding)) continue;
      throw DataError(ErrorCode::unsupported, path,
                      "has rotated axes (Direction) that are not along X, Y and Z; resample it along them");
    }
    char const world = "xyz"[largest];
    if (taken.find(world) != std::string::npos || std::abs(std::abs(along(largest)) - 1) > 1e-6) {
      throw DataError(ErrorCode::invalid_value, path,
                      "has a Direction that is neither a rotation nor a reflection; resample it along X, Y and Z");
    }
    taken += world;
    StoredAxis& axis = axes[column];
    axis.world = world;
    axis.step = grid.spacing[column] * (along(largest) < 0 ? -1 : 1);
    axis.stated = true;
    bool const between = place == VtkPlace::cells && grid.extent[2 * column + 1] > grid.extent[2 * column];
    axis.first = grid.origin[largest] + axis.step * (grid.extent[2 * column] + (between ? 0.5 : 0.0));
    if (axis.step == 0) axis.step = 1;  // check_grid() permits this only for a single node
  }
  return axes;
}

StoredAxes rectilinear_axes(VtkGrid const& grid, VtkPlace place, std::string const& path) {
  StoredAxes axes;
  for (std::size_t i = 0; i < 3; ++i) {
    std::vector<double> places = grid.coordinates[i];
    if (places.size() != static_cast<std::size_t>(VtkGrid::count(grid.extent, i, VtkPlace::points))) {
      throw DataError(ErrorCode::wrong_shape, path,
                      fmt::format("has {} coordinates along {} for {} points; write it anew", places.size(), "xyz"[i],
                                  VtkGrid::count(grid.extent, i, VtkPlace::points)));
    }
    if (place == VtkPlace::cells && places.size() > 1) {
      for (std::size_t k = 0; k + 1 < places.size(); ++k) places[k] = 0.5 * (places[k] + places[k + 1]);
      places.pop_back();
    }
    axes[i] = axis_from_coordinates(std::move(places), path, fmt::format("coordinates along {}", "xyz"[i]));
    axes[i].world = "xyz"[i];
  }
  return axes;
}

class VtkSource final : public CheckedSource {
 public:
  VtkSource(std::string const& path, VtkField field, FieldSelection const& selection)
      : CheckedSource(path, field.name, selection.values), field_(std::move(field)) {
    VtkGrid const& grid = field_.grid;
    bool const image = grid.coordinates[0].empty();
    axes_ = image ? image_axes(grid, field_.place, path) : rectilinear_axes(grid, field_.place, path);
    std::array<int, 3> nodes{};
    for (std::size_t i = 0; i < 3; ++i) nodes[i] = VtkGrid::count(grid.extent, i, field_.place);
    name_axes(axes_, selection.axes, 3, path);
    bool const turned = grid.direction != VtkGrid{}.direction;
    describe(nodes, 3,
             !selection.axes.empty() ? "axes = \"" + selection.axes + '"'
             : turned                ? "by its Direction"
                                     : "as VTK defines it");
    units_.spaced = true;
    units_.values = unit_suffix(field_.name).unit;
    notes_ = field_.notes;
    if (field_.place == VtkPlace::cells) reading_.by += "; data of cells, at their centres";
  }

 private:
  int significant_bits() const override { return field_.significant_bits; }

  void read_raw_rows(int plane, int first_row, int count, std::span<double> out) override {
    if (values_in_file_.size() == 0) values_in_file_ = field_.load();
    std::size_t const first = row_values() * (static_cast<std::size_t>(plane) * static_cast<std::size_t>(nodes_[1]) +
                                              static_cast<std::size_t>(first_row));
    for (std::size_t i = 0; i < row_values() * static_cast<std::size_t>(count); ++i)
      out[i] = values_in_file_[first + i];
  }

  VtkField field_;
  ValueStore values_in_file_;
};

}  // namespace

int VtkGrid::count(std::array<int, 6> const& extent, std::size_t axis, VtkPlace place) {
  int const cells = extent[2 * axis + 1] - extent[2 * axis];
  return place == VtkPlace::points ? cells + 1 : std::max(cells, 1);
}

void check_grid(VtkGrid const& grid, int values, std::string const& path) {
  double all = values;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double const points = 1.0 + grid.extent[2 * axis + 1] - grid.extent[2 * axis];
    double const spacing = grid.spacing[axis];
    bool const usable = points >= 1 && points <= std::numeric_limits<int>::max() && std::isfinite(grid.origin[axis]) &&
                        std::isfinite(spacing) && (spacing != 0 || points == 1);
    if (!usable) {
      throw DataError(ErrorCode::invalid_value, path,
                      "has no usable grid (its extent must ascend, Origin and Spacing must be finite, and Spacing "
                      "other than 0); write it anew");
    }
    all *= points;
  }
  if (all * sizeof(double) > 1e15)
    throw DataError(ErrorCode::out_of_range, path, "has an implausibly large grid; check its extent");
}

std::unique_ptr<CheckedSource> make_vtk_source(std::string const& path, VtkField field,
                                               FieldSelection const& selection) {
  return std::make_unique<VtkSource>(path, std::move(field), selection);
}

std::string no_such_array(FieldSelection const& selection, std::vector<std::string> const& names) {
  std::string const wanted =
      selection.values == 1 ? "scalar field" : fmt::format("field of {} components", selection.values);
  return fmt::format("has no {}{} among its data of points and cells{}", wanted,
                     selection.dataset.empty() ? "" : " \"" + selection.dataset + '"',
                     names.empty() ? "" : ", which are " + quoted_list(names));
}

}  // namespace gladstone::inline files
