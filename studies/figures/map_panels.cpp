#include "studies/figures/map_panels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "analysis/errors/error_summary.h"
#include "render/base/contracts.h"
#include "studies/figures/gnuplot.h"

namespace gladstone {
namespace {

constexpr char const* diverging_palette =
    "set palette defined (0 '#0b3c6f', 0.125 '#2a6fae', 0.25 '#6aacd0', 0.375 '#c3dcea', 0.5 '#f7f7f7', "
    "0.625 '#f9d3bf', 0.75 '#ec9374', 0.875 '#c43b3e', 1 '#6d0720')";
/// Viridis (S. van der Walt & N. Smith, CC0), sampled at nine points.
constexpr char const* viridis =
    "set palette defined (0 '#440154', 0.125 '#482878', 0.25 '#3e4a89', 0.375 '#31688e', 0.5 '#26828e', "
    "0.625 '#1f9e89', 0.75 '#6cce59', 0.875 '#b5de2b', 1 '#fde725')";

constexpr char const* grey_palette = "set palette defined (0 '#000000', 1 '#ffffff')";

char const* palette_of(ColourScale scale) {
  if (scale == ColourScale::diverging) return diverging_palette;
  return scale == ColourScale::grey ? grey_palette : viridis;
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
std::vector<ColourRange> ranges_of(std::vector<MapPanel> const& panels) {
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

/// Returns the smallest step of 1, 2 or 5 times a power of ten with at most `most` tics.
double tic_step(double length, double most) {
  double const least = length / most;
  double const power = std::pow(10.0, std::floor(std::log10(least)));
  for (double const factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least) return factor * power;
  }
  return 10.0 * power;
}

/// Dimensions of the layout in pixels.
struct Layout {
  static constexpr int above = 34, below = 28, edge = 14, bar_gap = 10, bar = 13;
  static constexpr int title = 44, heading = 34;
  int left = 40, right = 74, axis_label = 26;
  int map_width = 300;
  int map_height = 300;
  bool inner_tics = true;  ///< tic labels at every panel, not only at the outer ones
};

/// Determines the largest map with the proportions of the data that fits the width, with a height of at most 1.5
/// widths.
Layout layout_of(MapFigure const& figure, Image<double> const& map) {
  Layout layout;
  layout.map_width = figure.columns >= 4 ? 270 : 330;
  if (figure.columns >= 5) {
    layout.map_width = 200;
    layout.axis_label += layout.left - 12;
    layout.left = 12;
    layout.right = 72;
    layout.inner_tics = false;
  }
  double const width = map.columns() * std::abs(figure.axes.x_step);
  double const height = map.rows() * std::abs(figure.axes.y_step);
  double const ratio = height / width;
  if (ratio > 1.5) layout.map_width = std::max(60, static_cast<int>(layout.map_width * 1.5 / ratio));
  layout.map_height = std::max(40, static_cast<int>(std::lround(layout.map_width * ratio)));
  return layout;
}

/// Returns five tics including both ends of the range.
std::string colour_tics(ColourRange range) {
  constexpr int steps = 4;
  double const largest = std::max(std::abs(range.lower), std::abs(range.upper));
  // resolve the range to three digits
  int const decimals = static_cast<int>(2 - std::floor(std::log10(range.upper - range.lower)));
  std::string tics;
  for (int i = 0; i <= steps; ++i) {
    double const value = range.lower + (range.upper - range.lower) * i / steps;
    bool const zero = std::abs(value) < 1e-9 * largest;
    std::string const text = zero           ? "0"
                             : decimals > 5 ? fmt::format("{:.2e}", value)
                                            : fmt::format("{:.{}f}", value, std::max(0, decimals));
    tics += fmt::format("{}{} {:.10g}", i == 0 ? "" : ", ", GnuplotFigure::quoted_tic(text), value);
  }
  return tics;
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

/// Draws the panels of a map figure.
class MapDrawing {
 public:
  /// @pre a panel has a map
  explicit MapDrawing(MapFigure const& figure)
      : figure_(figure),
        layout_(layout_of(figure, first_map(figure))),
        count_(static_cast<int>(figure.panels.size())),
        rows_((count_ + figure.columns - 1) / figure.columns),
        ranges_(ranges_of(figure.panels)),
        cell_width_(layout_.left + layout_.map_width + layout_.right),
        width_(2 * Layout::edge + layout_.axis_label + figure.columns * cell_width_) {
    int y = Layout::edge + (figure_.title.empty() ? 0 : Layout::title);
    for (int row = 0; row < rows_; ++row) {
      if (!heading_of(row).empty()) y += Layout::heading;
      top_.push_back(y);
      y += Layout::above + layout_.map_height + Layout::below;
    }
    height_ = y + layout_.axis_label + Layout::edge;
  }

  void write(std::string const& path) const {
    GnuplotFigure plot(width_, height_);
    plot.command("set multiplot");
    set_headings(plot);
    for (int i = 0; i < count_; ++i) {
      MapPanel const& panel = figure_.panels[static_cast<std::size_t>(i)];
      if (panel.map.empty()) continue;
      place_panel(plot, i);
      set_colours(plot, panel, ranges_[static_cast<std::size_t>(i)]);
      set_axes(plot, panel, i);
      draw_map(plot, panel);
      for (int label = 1; label <= rows_ + 1; ++label) plot.command(fmt::format("unset label {}", label));
    }
    plot.command("unset multiplot");
    plot.write(path);
  }

 private:
  static Image<double> const& first_map(MapFigure const& figure) {
    GLADSTONE_EXPECTS(figure.columns > 0);
    auto const first = std::find_if(figure.panels.begin(), figure.panels.end(),
                                    [](MapPanel const& panel) { return !panel.map.empty(); });
    GLADSTONE_EXPECTS(first != figure.panels.end());
    return first->map;
  }

  std::string heading_of(int row) const {
    auto const i = static_cast<std::size_t>(row);
    return i < figure_.row_headings.size() ? figure_.row_headings[i] : std::string{};
  }

  double screen_x(double x_px) const { return x_px / width_; }
  double screen_y(double y_px) const { return 1.0 - y_px / height_; }

  /// Sets the title of the figure and the headings of its rows.
  void set_headings(GnuplotFigure& plot) const {
    if (!figure_.title.empty()) {
      plot.command(fmt::format("set label 1 {} at screen 0.5, {:.6f} center font 'DejaVu Sans,15' textcolor '#101010'",
                               GnuplotFigure::quoted(figure_.title), screen_y(Layout::edge + 0.4 * Layout::title)));
    }
    for (int row = 0; row < rows_; ++row) {
      if (heading_of(row).empty()) continue;
      plot.command(fmt::format(
          "set label {} {} at screen {:.6f}, {:.6f} left font 'DejaVu Sans Bold,13' textcolor '#101010'", row + 2,
          GnuplotFigure::quoted(heading_of(row)), screen_x(Layout::edge + layout_.axis_label + layout_.left),
          screen_y(top_[static_cast<std::size_t>(row)] - 0.5 * Layout::heading)));
    }
  }

  /// Sets the margins of panel i and the place of its colour bar.
  void place_panel(GnuplotFigure& plot, int i) const {
    int const row = i / figure_.columns, column = i % figure_.columns;
    int const left = Layout::edge + layout_.axis_label + column * cell_width_ + layout_.left;
    int const upper = top_[static_cast<std::size_t>(row)] + Layout::above;
    plot.command(fmt::format("set lmargin at screen {:.6f}; set rmargin at screen {:.6f}", screen_x(left),
                             screen_x(left + layout_.map_width)));
    plot.command(fmt::format("set tmargin at screen {:.6f}; set bmargin at screen {:.6f}", screen_y(upper),
                             screen_y(upper + layout_.map_height)));
    plot.command(fmt::format("set colorbox user origin screen {:.6f}, screen {:.6f} size screen {:.6f}, screen {:.6f}",
                             screen_x(left + layout_.map_width + Layout::bar_gap), screen_y(upper + layout_.map_height),
                             screen_x(Layout::bar), layout_.map_height / static_cast<double>(height_)));
  }

  /// Sets title, palette and colour bar of a panel.
  void set_colours(GnuplotFigure& plot, MapPanel const& panel, ColourRange range) const {
    plot.command(fmt::format("set title {} font 'DejaVu Sans,12' offset 0,-0.5 textcolor '#101010'",
                             GnuplotFigure::quoted(panel.title)));
    plot.command(palette_of(panel.scale));
    plot.command(
        fmt::format("set cbrange [{:.10g}:{:.10g}]; set cbtics ({}) font 'DejaVu Sans,9' scale 0.3 offset -0.8,0",
                    range.lower, range.upper, colour_tics(range)));
  }

  /// Sets ranges, tics and labels of the axes of panel i.
  void set_axes(GnuplotFigure& plot, MapPanel const& panel, int i) const {
    MapAxes const& axes = figure_.axes;
    int const column = i % figure_.columns;
    double const half_x = 0.5 * std::abs(axes.x_step), half_y = 0.5 * std::abs(axes.y_step);
    double const x_end = axes.x_first + axes.x_step * (panel.map.columns() - 1);
    double const y_end = axes.y_first + axes.y_step * (panel.map.rows() - 1);
    plot.command(fmt::format("set xrange [{:.10g}:{:.10g}]", std::min(axes.x_first, x_end) - half_x,
                             std::max(axes.x_first, x_end) + half_x));
    double const y_low = std::min(axes.y_first, y_end) - half_y;
    double const y_high = std::max(axes.y_first, y_end) + half_y;
    plot.command(axes.y_down ? fmt::format("set yrange [{:.10g}:{:.10g}]", y_high, y_low)
                             : fmt::format("set yrange [{:.10g}:{:.10g}]", y_low, y_high));
    double const x_span = std::abs(axes.x_step) * panel.map.columns();
    plot.command(fmt::format(
        "set xtics {:.10g} font 'DejaVu Sans,9' offset 0,0.4; set ytics {:.10g} font 'DejaVu Sans,9' offset 0.6,0",
        tic_step(x_span, layout_.map_width / 42.0), tic_step(y_high - y_low, layout_.map_height / 36.0)));
    bool const lowest = i + figure_.columns >= count_;
    plot.command(fmt::format("set format x '{}'; set format y '{}'", layout_.inner_tics || lowest ? "% h" : "",
                             layout_.inner_tics || column == 0 ? "% h" : ""));
    plot.command(lowest ? fmt::format("set xlabel {} offset 0,0.8", GnuplotFigure::quoted(axes.x_label))
                        : std::string("unset xlabel"));
    plot.command(column == 0 ? fmt::format("set ylabel {} offset 1.6,0", GnuplotFigure::quoted(axes.y_label))
                             : std::string("unset ylabel"));
  }

  /// Draws the map of a panel, on grey for missing values.
  void draw_map(GnuplotFigure& plot, MapPanel const& panel) const {
    MapAxes const& axes = figure_.axes;
    plot.command(
        "set object 1 rectangle from graph 0,0 to graph 1,1 fillcolor '#b8b8b8' fillstyle solid noborder behind");
    auto const [map, factor] = reduced(panel.map, layout_.map_width);
    std::string const source = plot.add_map(map, axes.x_first + 0.5 * (factor - 1) * axes.x_step, factor * axes.x_step,
                                            axes.y_first + 0.5 * (factor - 1) * axes.y_step, factor * axes.y_step);
    plot.command(fmt::format("plot {} with image", source));
  }

  MapFigure const& figure_;
  Layout layout_;
  int count_, rows_;  ///< number of panels, and of their rows
  std::vector<ColourRange> ranges_;
  int cell_width_, width_, height_ = 0;  ///< width of a panel with its margins, and size of the figure [px]
  std::vector<int> top_;                 ///< upper end of each row [px]
};

}  // namespace

char const* sequential_palette() { return viridis; }

ColourRange colour_range(Image<double> const& map, ColourScale scale) { return range_of(finite_values(map), scale); }

void write_map_figure(std::string const& path, MapFigure const& figure) { MapDrawing(figure).write(path); }

}  // namespace gladstone
