#include "studies/figures/map_panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "analysis/errors/error_summary.h"
#include "render/base/contracts.h"

namespace gladstone::inline figures {
namespace {

using namespace plot;

Palette select_palette(ColourScale scale) {
  if (scale == ColourScale::diverging) return Palette::diverging;
  return scale == ColourScale::grey ? Palette::grey : Palette::sequential;
}

ColourRange range_of(std::vector<double> const& values, ColourScale scale) {
  if (values.empty()) return {scale == ColourScale::diverging ? -1.0 : 0.0, 1.0};
  ColourRange range;
  if (scale == ColourScale::sequential) {
    range = {quantile(values, 0.0025), quantile(values, 0.9975)};
  } else {
    std::vector<double> magnitude(values);
    for (double& value : magnitude) value = std::abs(value);
    range.upper = quantile(std::move(magnitude), 0.9975);
    range.lower = scale == ColourScale::diverging ? -range.upper : 0.0;
  }
  if (range.upper > range.lower) return range;
  // widen the range of a constant map
  double const half = range.upper == 0.0 ? 1.0 : 1e-3 * std::abs(range.upper);
  return scale == ColourScale::magnitude || scale == ColourScale::grey
             ? ColourRange{0.0, half}
             : ColourRange{range.lower - half, range.upper + half};
}

std::vector<double> finite_values(Image<double> const& map) {
  std::vector<double> values;
  std::copy_if(map.begin(), map.end(), std::back_inserter(values), [](double value) { return std::isfinite(value); });
  return values;
}

/// Returns the range of every panel, shared within its group.
std::vector<ColourRange> determine_ranges(std::vector<MapPanel> const& panels) {
  std::map<std::string, std::vector<double>> values;
  auto const group = [&](std::size_t i) {
    return panels[i].range_group.empty() ? "panel " + std::to_string(i) : "group " + panels[i].range_group;
  };
  for (std::size_t i = 0; i < panels.size(); ++i) {
    std::vector<double> const own = finite_values(panels[i].map);
    values[group(i)].insert(values[group(i)].end(), own.begin(), own.end());
  }
  std::vector<ColourRange> ranges;
  for (std::size_t i = 0; i < panels.size(); ++i) {
    ColourRange range = range_of(values[group(i)], panels[i].scale);
    if (std::isfinite(panels[i].lower)) range.lower = panels[i].lower;
    if (std::isfinite(panels[i].upper)) range.upper = panels[i].upper;
    ranges.push_back(range);
  }
  return ranges;
}

/// Dimensions of the layout in pixels.
struct MapLayout {
  static constexpr int above = 34, below = 28, edge = 14;
  static constexpr int title = 44, heading = 34;
  int left = 40, right = 86, axis_label = 26;
  int map_width = 300;
  int map_height = 300;
  bool inner_ticks = true;  ///< tick texts at every panel, not only at the outer ones
};

/// Determines the largest map with the proportions of the data that fits the width, with a height of at most 1.5
/// widths.
MapLayout map_layout(MapFigure const& figure, Image<double> const& map) {
  MapLayout layout;
  layout.map_width = figure.columns >= 4 ? 270 : 330;
  if (figure.columns >= 5) {
    layout.map_width = 200;
    layout.axis_label += layout.left - 12;
    layout.left = 12;
    layout.right = 82;
    layout.inner_ticks = false;
  }
  double const width = map.columns() * std::abs(figure.axes.x_step);
  double const height = map.rows() * std::abs(figure.axes.y_step);
  double const ratio = height / width;
  if (ratio > 1.5) layout.map_width = std::max(60, static_cast<int>(layout.map_width * 1.5 / ratio));
  layout.map_height = std::max(40, static_cast<int>(std::lround(layout.map_width * ratio)));
  return layout;
}

/// Returns five ticks including both ends of the range.
std::vector<Tick> colour_ticks(ColourRange range) {
  constexpr int steps = 4;
  double const largest = std::max(std::abs(range.lower), std::abs(range.upper));
  // resolve the range to three digits
  int const decimals = static_cast<int>(2 - std::floor(std::log10(range.upper - range.lower)));
  std::vector<Tick> ticks;
  for (int i = 0; i <= steps; ++i) {
    double const value = range.lower + (range.upper - range.lower) * i / steps;
    bool const zero = std::abs(value) < 1e-9 * largest;
    ticks.push_back({value, zero           ? "0"
                            : decimals > 5 ? fmt::format("{:.2e}", value)
                                           : fmt::format("{:.{}f}", value, std::max(0, decimals))});
  }
  return ticks;
}

/// Averages blocks of pixels if the map is much finer than the figure, to avoid aliasing.
std::pair<Image<double>, int> reduced(Image<double> const& map, int width_px) {
  int const factor = std::max(1, map.columns() / (2 * width_px));
  if (factor == 1 || map.rows() < factor) return {map, 1};
  Image<double> small(map.columns() / factor, map.rows() / factor);
  for (int row = 0; row < small.rows(); ++row) {
    for (int column = 0; column < small.columns(); ++column) {
      double sum = 0.0;
      for (int j = 0; j < factor; ++j) {
        for (int i = 0; i < factor; ++i) sum += map(column * factor + i, row * factor + j);
      }
      small(column, row) = sum / (factor * factor);
    }
  }
  return {std::move(small), factor};
}

Image<double> const& first_map(MapFigure const& figure) {
  GLADSTONE_EXPECTS(figure.columns > 0);
  auto const first = std::find_if(figure.panels.begin(), figure.panels.end(),
                                  [](MapPanel const& panel) { return !panel.map.empty(); });
  GLADSTONE_EXPECTS(first != figure.panels.end());
  return first->map;
}

/// Returns the axis of nodes first + step i, with ticks at most every `apart` pixels.
Axis node_axis(double first, double step, int nodes, double length_px, double apart) {
  double const last = first + step * (nodes - 1), half = 0.5 * std::abs(step);
  Axis axis{.low = std::min(first, last) - half, .high = std::max(first, last) + half};
  axis.ticks = linear_ticks(axis.low, axis.high, length_px / apart);
  return axis;
}

/// Returns a panel without its position and the labels of its axes.
Panel make_map_panel(MapPanel const& from, MapAxes const& axes, MapLayout const& layout, ColourRange range) {
  Panel panel{.title = from.title};
  panel.x = node_axis(axes.x_first, axes.x_step, from.map.columns(), layout.map_width, 42);
  panel.y = node_axis(axes.y_first, axes.y_step, from.map.rows(), layout.map_height, 36);
  if (axes.y_down) std::swap(panel.y.low, panel.y.high);
  auto [map, factor] = reduced(from.map, layout.map_width);
  double const shift = 0.5 * (factor - 1);
  panel.map = Map{std::move(map),       axes.x_first + shift * axes.x_step,
                  factor * axes.x_step, axes.y_first + shift * axes.y_step,
                  factor * axes.y_step, select_palette(from.scale),
                  range.lower,          range.upper};
  panel.map->ticks = colour_ticks(range);
  return panel;
}

}  // namespace

ColourRange colour_range(Image<double> const& map, ColourScale scale) { return range_of(finite_values(map), scale); }

Figure make_map_figure(MapFigure const& maps) {
  MapLayout const layout = map_layout(maps, first_map(maps));
  std::vector<ColourRange> const ranges = determine_ranges(maps.panels);
  int const count = static_cast<int>(maps.panels.size());
  int const left = MapLayout::edge + layout.axis_label + layout.left;
  int const cell_width = layout.left + layout.map_width + layout.right;
  Figure figure{2 * MapLayout::edge + layout.axis_label + maps.columns * cell_width, 0, Figure::Kind::map};
  int top = MapLayout::edge;
  if (!maps.title.empty()) {
    figure.add_title(maps.title);
    top += MapLayout::title;
  }
  for (int i = 0; i < count; ++i) {
    int const row = i / maps.columns, column = i % maps.columns;
    if (column == 0 && row > 0) top += MapLayout::above + layout.map_height + MapLayout::below;
    auto const heading = static_cast<std::size_t>(row);
    if (column == 0 && heading < maps.row_headings.size() && !maps.row_headings[heading].empty()) {
      top += MapLayout::heading;
      figure.labels.push_back({maps.row_headings[heading], static_cast<double>(left), top - 0.5 * MapLayout::heading,
                               TextRole::heading, Align::left});
    }
    MapPanel const& from = maps.panels[static_cast<std::size_t>(i)];
    if (from.map.empty()) continue;
    Panel panel = make_map_panel(from, maps.axes, layout, ranges[static_cast<std::size_t>(i)]);
    bool const lowest = i + maps.columns >= count;
    if (lowest) panel.x.label = maps.axes.x_label;
    if (column == 0) panel.y.label = maps.axes.y_label;
    if (!layout.inner_ticks && !lowest) panel.x.marks = Axis::Marks::ticks;
    if (!layout.inner_ticks && column > 0) panel.y.marks = Axis::Marks::ticks;
    double const x = left + column * cell_width, y = top + MapLayout::above;
    panel.box = {x, x + layout.map_width, y, y + layout.map_height};
    figure.panels.push_back(std::move(panel));
  }
  figure.height_px =
      top + MapLayout::above + layout.map_height + MapLayout::below + layout.axis_label + MapLayout::edge;
  return figure;
}

}  // namespace gladstone::inline figures
