#include "studies/figures/field_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "render/base/available_memory.h"
#include "render/base/error.h"
#include "render/base/image.h"
#include "render/base/interrupt.h"
#include "render/base/progress.h"
#include "render/base/units.h"
#include "studies/figures/map_panels.h"

namespace gladstone::inline figures {
namespace {

using namespace plot;

// dimensions of the figure [px]
constexpr int plane_width = 330, least_height = 60, most_height = 495, to_left = 66, to_right = 24, above_plane = 72,
              below_plane = 74, bar_space = 90;

/// Values in one plane; columns along the axis `across`, rows along `up`, both ascending.
struct FieldPlane {
  int across, up, normal;  ///< axes of the world: 0, 1, 2
  Image<double> map;
};

/// Reads the three planes through the middle nodes in one pass over the field.
std::vector<FieldPlane> read_middle_planes(FieldSource& source) {
  std::array<int, 3> const& nodes = source.grid().nodes;
  std::vector<FieldPlane> planes;
  for (auto const& [across, up, normal] :
       {std::array<int, 3>{0, 1, 2}, std::array<int, 3>{0, 2, 1}, std::array<int, 3>{2, 1, 0}}) {
    planes.push_back({across, up, normal,
                      Image<double>(nodes[static_cast<std::size_t>(across)], nodes[static_cast<std::size_t>(up)])});
  }
  auto const components = static_cast<std::size_t>(source.values());
  std::size_t const count = static_cast<std::size_t>(nodes[0]) * static_cast<std::size_t>(nodes[1]) * components;
  require_memory(source.name(), "a plane of " + std::to_string(count) + " values",
                 sizeof(double) * static_cast<double>(count));
  std::vector<double> values(count);
  auto const at = [&](int i, int j) {
    std::size_t const node =
        static_cast<std::size_t>(j) * static_cast<std::size_t>(nodes[0]) + static_cast<std::size_t>(i);
    double const* const value = values.data() + node * components;
    return components == 1 ? *value : std::sqrt(std::inner_product(value, value + components, value, 0.0));
  };
  Progress progress("drawing " + source.name(), static_cast<std::size_t>(nodes[2]));
  for (int k = 0; k < nodes[2]; ++k) {
    throw_if_interrupted();
    source.read_planes(k, 1, values);
    for (int j = 0; j < nodes[1]; ++j) {
      for (int i = 0; k == nodes[2] / 2 && i < nodes[0]; ++i) planes[0].map(i, j) = at(i, j);
      planes[2].map(k, j) = at(nodes[0] / 2, j);
    }
    for (int i = 0; i < nodes[0]; ++i) planes[1].map(i, k) = at(i, nodes[1] / 2);
    progress.advance();
  }
  std::erase_if(planes, [](FieldPlane const& plane) { return plane.map.columns() < 2 || plane.map.rows() < 2; });
  return planes;
}

/// Coordinates of the nodes along an axis, in mm or numbers of nodes.
struct NodeAxis {
  NodeAxis(FieldSource const& source, int axis, bool lengths_known)
      : nodes(source.grid().nodes[static_cast<std::size_t>(axis)]) {
    char const name = "xyz"[axis];
    if (lengths_known) {
      double const unit_mm = source.units().metres() / unit::millimetre;
      first = source.grid().origin[axis] * unit_mm;
      step = source.grid().spacing[axis] * unit_mm;
    }
    label = fmt::format("{} [{}]", name, lengths_known ? "mm" : "nodes");
    int const node = nodes / 2;
    middle = lengths_known ? fmt::format("{} = {:.4g} mm", name, first + step * node)
                           : fmt::format("{} = node {}", name, node);
  }
  double length() const { return step * nodes; }
  /// @param most  maximum number of ticks
  Axis axis(double most) const {
    double const low = first - step / 2, high = first + step * (nodes - 0.5);
    return {label, low, high, false, linear_ticks(low, high, std::max(1.0, most))};
  }

  int nodes;
  double first = 0, step = 1;
  std::string label;
  std::string middle;  ///< position of the middle node
};

}  // namespace

Figure make_field_figure(FieldSource& source, bool lengths_known) {
  std::vector<FieldPlane> planes = read_middle_planes(source);
  if (planes.empty())
    throw DataError(
        ErrorCode::wrong_shape, source.name(),
        "cannot be drawn (a figure requires at least two nodes along two axes of the field); omit --figure");
  std::vector<NodeAxis> axes;
  for (int axis = 0; axis < 3; ++axis) axes.emplace_back(source, axis, lengths_known);
  auto const axis_of = [&axes](int axis) -> NodeAxis const& { return axes[static_cast<std::size_t>(axis)]; };
  std::vector<int> heights;
  ColourRange range = colour_range(planes.front().map, ColourScale::sequential);
  for (FieldPlane const& plane : planes) {
    double const ratio = axis_of(plane.up).length() / axis_of(plane.across).length();
    heights.push_back(std::clamp(static_cast<int>(std::lround(plane_width * ratio)), least_height, most_height));
    ColourRange const own = colour_range(plane.map, ColourScale::sequential);
    range = {std::min(range.lower, own.lower), std::max(range.upper, own.upper)};
  }
  int const cell = to_left + plane_width + to_right, tallest = *std::max_element(heights.begin(), heights.end());
  int const drawn = static_cast<int>(planes.size());
  Figure figure{drawn * cell + bar_space, above_plane + tallest + below_plane, Figure::Kind::map};
  std::string const unit_name = source.units().values.empty() ? "" : " [" + source.units().values + ']';
  figure.add_title(source.name() + (source.values() > 1 ? ", magnitude" : "") + unit_name);
  for (int i = 0; i < drawn; ++i) {
    FieldPlane& plane = planes[static_cast<std::size_t>(i)];
    NodeAxis const &across = axis_of(plane.across), &up = axis_of(plane.up);
    int const height = heights[static_cast<std::size_t>(i)];
    double const left = i * cell + to_left;
    Panel panel{.box = {left, left + plane_width, above_plane, static_cast<double>(above_plane + height)},
                .title = axis_of(plane.normal).middle,
                .x = across.axis(plane_width / 42.0),
                .y = up.axis(height / 36.0)};
    panel.map = Map{std::move(plane.map), across.first, across.step, up.first, up.step};
    panel.map->low = range.lower;
    panel.map->high = range.upper;
    panel.map->has_bar = i == drawn - 1;
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace gladstone::inline figures
