#include "render/files/fields/oriented_field.h"

#include <algorithm>
#include <cmath>

#include "render/base/contracts.h"

namespace gladstone::inline files {

OrientedField::OrientedField(std::unique_ptr<CheckedSource> stored)
    : FieldSource(stored->values()), stored_(std::move(stored)) {
  StoredAxes const& axes = stored_->axes();
  for (std::size_t i = 0; i < 3; ++i) {
    StoredAxis const& axis = axes[i];
    auto const world = static_cast<std::size_t>(axis.world - 'x');
    int const nodes = stored_->nodes()[i];
    stored_axis_[world] = i;
    backwards_[world] = nodes > 1 && axis.step < 0;
    grid_.nodes[world] = nodes;
    grid_.spacing[static_cast<int>(world)] = std::abs(axis.step);
    grid_.origin[static_cast<int>(world)] = axis.first + (backwards_[world] ? axis.step * (nodes - 1) : 0.0);
    coordinates_[world] = axis.coordinates;
    if (backwards_[world]) std::reverse(coordinates_[world].begin(), coordinates_[world].end());
  }
}

bool OrientedField::uniform() const {
  return std::all_of(coordinates_.begin(), coordinates_.end(), [](auto const& axis) { return axis.empty(); });
}

void OrientedField::read_planes(int first_plane, int count, std::span<double> out) {
  GLADSTONE_EXPECTS(first_plane >= 0 && count >= 0 && count <= grid_.nodes[2] - first_plane);
  std::size_t const plane = static_cast<std::size_t>(values()) * static_cast<std::size_t>(grid_.nodes[0]) *
                            static_cast<std::size_t>(grid_.nodes[1]);
  GLADSTONE_EXPECTS(out.size() == plane * static_cast<std::size_t>(count));
  for (int z = 0; z < count; ++z) {
    read_rows(first_plane + z, 0, grid_.nodes[1], out.subspan(static_cast<std::size_t>(z) * plane, plane));
  }
}

void OrientedField::read_rows(int plane, int first_row, int count, std::span<double> out) {
  bool const in_order = stored_axis_ == std::array<std::size_t, 3>{0, 1, 2};
  if (in_order) {
    int const from = backwards_[1] ? grid_.nodes[1] - first_row - count : first_row;
    stored_->read_rows(backwards_[2] ? grid_.nodes[2] - 1 - plane : plane, from, count, out);
    turn_rows(count, out);
    return;
  }
  GLADSTONE_EXPECTS(plane >= 0 && plane < grid_.nodes[2]);
  GLADSTONE_EXPECTS(first_row >= 0 && count >= 0 && count <= grid_.nodes[1] - first_row);
  load();
  auto const width = static_cast<std::size_t>(values());
  std::array<std::size_t, 3> const strides{width, stored_->row_values(),
                                           stored_->row_values() * static_cast<std::size_t>(stored_->nodes()[1])};
  auto const offset = [&](std::size_t axis, int node) {
    int const stored = backwards_[axis] ? grid_.nodes[axis] - 1 - node : node;
    return strides[stored_axis_[axis]] * static_cast<std::size_t>(stored);
  };
  auto value = out.begin();
  for (int y = first_row; y < first_row + count; ++y) {
    for (int x = 0; x < grid_.nodes[0]; ++x) {
      std::size_t const node = offset(0, x) + offset(1, y) + offset(2, plane);
      for (std::size_t component = 0; component < width; ++component) *value++ = all_[node + component];
    }
  }
}

void OrientedField::turn_rows(int count, std::span<double> rows) const {
  auto const nodes = static_cast<std::size_t>(grid_.nodes[0]), width = static_cast<std::size_t>(values());
  std::size_t const row = nodes * width;
  auto const last = static_cast<std::size_t>(count);
  for (std::size_t i = 0; backwards_[1] && i < last / 2; ++i) {
    auto const a = rows.subspan(i * row, row), b = rows.subspan((last - 1 - i) * row, row);
    std::swap_ranges(a.begin(), a.end(), b.begin());
  }
  for (std::size_t i = 0; backwards_[0] && i < last; ++i) {
    auto const line = rows.subspan(i * row, row);
    for (std::size_t node = 0; node < nodes / 2; ++node) {
      auto const a = line.subspan(node * width, width), b = line.subspan((nodes - 1 - node) * width, width);
      std::swap_ranges(a.begin(), a.end(), b.begin());
    }
  }
}

void OrientedField::load() {
  if (all_.size() > 0) return;
  std::size_t const row = stored_->row_values(), rows = static_cast<std::size_t>(stored_->nodes()[1]);
  ValueStore values;
  values.allocate(row * rows * static_cast<std::size_t>(stored_->nodes()[2]), significant_bits(), path(),
                  "field \"" + name() + "\", whose axes are exchanged,");
  std::vector<double> line(row);
  std::size_t at = 0;
  for (int plane = 0; plane < stored_->nodes()[2]; ++plane) {
    for (int i = 0; i < stored_->nodes()[1]; ++i) {
      stored_->read_rows(plane, i, 1, line);
      for (double const value : line) values.set(at++, value);
    }
  }
  all_ = std::move(values);
}

}  // namespace gladstone::inline files
