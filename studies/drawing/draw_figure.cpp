#include "studies/drawing/draw_figure.h"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "render/base/contracts.h"
#include "studies/drawing/figure_texts.h"
#include "studies/drawing/gnuplot.h"
#include "studies/drawing/templates.h"

namespace gladstone::inline drawing {
namespace {

using plot::Axis;
using plot::Box;
using plot::Layer;
using plot::LegendPlace;
using plot::Panel;

constexpr double title_above = 16;              ///< distance from the title of a panel to its upper edge [px]
constexpr double bar_gap = 10, bar_width = 13;  ///< distance from a map to its colour bar, and width of the bar [px]
constexpr double title_beyond = 30;             ///< maximum length by which a panel's title may extend beyond the panel
                                                ///< on each side [px]
constexpr int most_cells = 400;                 ///< maximum number of cells of maps that are drawn cell by cell

std::string quoted(std::string_view text) { return GnuplotScript::quoted(text); }

std::string coordinate(double value) { return std::isfinite(value) ? fmt::format("{:.10g}", value) : "*"; }

/// @param texts  false: the ticks are drawn without their texts
std::string tick_list(std::vector<plot::Tick> const& ticks, bool texts) {
  std::string list;
  for (plot::Tick const& tick : ticks) {
    list += fmt::format("{}{} {:.10g}", list.empty() ? "" : ", ", GnuplotScript::quoted_tick(texts ? tick.text : ""),
                        tick.at);
  }
  return '(' + list + ')';
}

std::string dash_type(plot::Dash dash) {
  return dash == plot::Dash::solid ? "" : dash == plot::Dash::dashed ? " dashtype 2" : " dashtype 3";
}

bool has_point(Layer const& layer) {
  for (std::size_t i = 0; !layer.columns.empty() && i < layer.columns.front().size(); ++i) {
    if (std::isfinite(layer.columns[0][i]) && std::isfinite(layer.columns[1][i])) return true;
  }
  return false;
}

/// Writes the script of a figure.
class FigureScript {
 public:
  explicit FigureScript(Figure const& figure) : figure_(figure) {
    script_.add_file("look.gp", embedded::figure_look);
    script_.add_file("map.gp", embedded::figure_map);
    script_.add_file("drawing.gp", embedded::figure_drawing);
    script_.command("set multiplot");
    for (Panel const& panel : figure.panels) add(panel);
    script_.command("unset multiplot");
  }

  void write(std::string const& path) const {
    FigureFont const font = font_of(figure_.kind, "base");
    script_.write(path, figure_.width_px, figure_.height_px, quoted(fmt::format("{},{}", font.family, font.size)));
  }

 private:
  template <class... Values>
  void command(fmt::format_string<Values...> text, Values&&... values) {
    script_.command(fmt::format(text, std::forward<Values>(values)...));
  }

  double screen_x(double x_px) const { return x_px / figure_.width_px; }
  double screen_y(double y_px) const { return 1 - y_px / figure_.height_px; }

  void add(Panel const& panel) {
    // a panel begins without the settings of the one before
    command("reset; load 'look.gp'");
    if (figure_.kind == Figure::Kind::map) command("load 'map.gp'");
    if (figure_.kind == Figure::Kind::drawing) command("load 'drawing.gp'");
    if (&panel == &figure_.panels.front()) {
      for (PlacedText const& text : place_texts(figure_)) add(text);
    }
    add_frame(panel);
    add_axis(panel.x, 'x');
    add_axis(panel.y, 'y');
    add_labels(panel);
    add_legend(panel);
    std::vector<std::string> elements;
    bool is_empty = !panel.map;
    if (panel.map) elements.push_back(map_element(*panel.map, panel.box));
    for (Layer const& layer : panel.layers) {
      if (layer.kind == Layer::Kind::guides) {
        add_guides(layer);
      } else if (has_point(layer)) {
        elements.push_back(element(layer));
        is_empty = false;
      } else if (!layer.name.empty()) {
        elements.push_back(fmt::format("NaN with lines linecolor '{}' title {}", layer.colour, quoted(layer.name)));
      }
    }
    if (is_empty) {  // gnuplot does not determine a range without data
      if (!std::isfinite(panel.x.low + panel.x.high)) command("set xrange [0:1]");
      if (!std::isfinite(panel.y.low + panel.y.high)) command("unset logscale y; set yrange [0:1]");
    }
    command("plot {}", elements.empty() ? "NaN" : fmt::format("{}", fmt::join(elements, ", ")));
  }

  void add_frame(Panel const& panel) {
    Box const& box = panel.box;
    command("set lmargin at screen {:.6f}; set rmargin at screen {:.6f}", screen_x(box.left), screen_x(box.right));
    command("set tmargin at screen {:.6f}; set bmargin at screen {:.6f}", screen_y(box.top), screen_y(box.bottom));
    if (panel.border != plot::Border::full) command("set border {}", panel.border == plot::Border::bottom ? 1 : 0);
    if (panel.equal_scales) command("set size ratio -1");
    if (panel.grid != plot::Grid::none) {
      command("set grid {} @grid", panel.grid == plot::Grid::both ? "xtics ytics" : "noxtics ytics");
    }
  }

  /// @param name  'x' or 'y'
  void add_axis(Axis const& axis, char name) {
    command("set {}range [{}:{}]", name, coordinate(axis.low), coordinate(axis.high));
    if (axis.logarithmic) command("set logscale {}; set format {} '%g'", name, name);
    if (!axis.label.empty()) command("set {0}label {1} @{0}label_look", name, quoted(axis.label));
    if (axis.marks == Axis::Marks::none) return command("unset {}tics", name);
    bool const texts = axis.marks != Axis::Marks::ticks;
    if (!texts) command("set format {} ''", name);
    // the list comes first: a string variable before a bracket would be a function
    command("set {0}tics {1}{2}{3} @ticks @{0}ticks_look", name,
            axis.ticks.empty() ? "autofreq" : tick_list(axis.ticks, texts),
            axis.marks == Axis::Marks::bare ? " scale 0" : "", axis.slanted ? " rotate by 28 right" : "");
  }

  void add(PlacedText const& text) {
    std::string_view const role = to_string(text.label.role);
    add_label(text.label, fmt::format("screen {:.6f},{:.6f}", screen_x(text.label.x), screen_y(text.label.y)),
              fmt::format("'{},{:.4g}'", text.font.family, text.font.size), role);
  }

  void add_label(plot::Label const& label, std::string const& place, std::string const& font, std::string_view role) {
    std::string const colour = label.colour.empty() ? fmt::format("{}_colour", role) : quoted(label.colour);
    command("set label {} at {} {} front {} font {} textcolor rgb {}", quoted(label.text), place,
            label.align == plot::Align::left    ? "left"
            : label.align == plot::Align::right ? "right"
                                                : "center",
            label.boxed ? "boxed" : "", font, colour);
  }

  void add_labels(Panel const& panel) {
    if (!panel.title.empty()) {
      plot::Label const title{panel.title, (panel.box.left + panel.box.right) / 2, panel.box.top - title_above};
      FigureFont font = font_of(figure_.kind, "panel");
      double const room = panel.box.right - panel.box.left + 2 * title_beyond, width = text_width(panel.title, font);
      if (width > room) font.size *= room / width;
      add_label(title, fmt::format("screen {:.6f},{:.6f}", screen_x(title.x), screen_y(title.y)),
                fmt::format("'{},{:.4g}'", font.family, font.size), "panel");
    }
    std::vector<PlacedText> const placed = place_labels(figure_, panel);
    for (PlacedText const& text : placed) add(text);
    if (!placed.empty()) return;
    for (plot::Label const& label : panel.labels) {
      std::string_view const role = to_string(label.role);
      add_label(label,
                fmt::format("first {:.10g},{:.10g} offset screen {:.6f},{:.6f}", label.x, label.y,
                            screen_x(label.right_px), -label.down_px / figure_.height_px),
                fmt::format("{}_font", role), role);
    }
  }

  void add_legend(Panel const& panel) {
    plot::Legend const& legend = panel.legend;
    Box const& box = panel.box;
    std::string place;
    switch (legend.place) {
      case LegendPlace::none:
        return command("unset key");
      case LegendPlace::top_left:
        place = "top left";
        break;
      case LegendPlace::top_right:
        place = "top right";
        break;
      case LegendPlace::bottom_left:
        place = "bottom left";
        break;
      case LegendPlace::bottom_right:
        place = "bottom right";
        break;
      case LegendPlace::above:
        // a panel of equal scales may be lower than its place
        place = panel.equal_scales ? "at graph 0, graph 1 left bottom"
                                   : fmt::format("at graph 0, screen {:.6f} left top", screen_y(legend.top_px));
        break;
      case LegendPlace::above_right:
        place = fmt::format("at graph 1, screen {:.6f} right top", screen_y(legend.top_px));
        break;
      case LegendPlace::right:
        place = fmt::format("at screen {:.6f}, graph 1 left top", screen_x(box.right + legend_gap));
        break;
      case LegendPlace::below:
        place = fmt::format("at screen {:.6f}, screen {:.6f} center bottom", screen_x((box.left + box.right) / 2),
                            screen_y(figure_.height_px - 8.0));
        break;
    }
    command("set key {} {} @legend", place, legend.horizontal ? "horizontal maxrows 2" : "vertical");
  }

  void add_guides(Layer const& layer) {
    for (double const x : layer.columns.front()) {
      command(
          "set arrow from first {0:.10g},graph 0 to first {0:.10g},graph 1 nohead front linewidth {1} linecolor "
          "'{2}'{3}",
          x, layer.width, layer.colour, dash_type(layer.dash));
    }
  }

  /// Returns the element of the plot command that draws a map, and sets its colours.
  std::string map_element(plot::Map const& map, Box const& box) {
    constexpr std::array<char const*, 3> palettes{"diverging", "sequential", "grey"};
    command("set object 1 rectangle from graph 0,0 to graph 1,1 @missing behind");
    command("set palette @{}", palettes[static_cast<std::size_t>(map.palette)]);
    command("set cbrange [{:.10g}:{:.10g}]{}", map.low, map.high, map.logarithmic ? "; set logscale cb" : "");
    if (map.has_bar) {
      command("set colorbox user origin screen {:.6f}, screen {:.6f} size screen {:.6f}, screen {:.6f}",
              screen_x(box.right + bar_gap), screen_y(box.bottom), screen_x(bar_width),
              (box.bottom - box.top) / figure_.height_px);
      command("set cbtics {} @bar_ticks", map.ticks.empty() ? "autofreq" : tick_list(map.ticks, true));
    } else {
      command("unset colorbox");
    }
    bool const few = map.values.size() <= most_cells;
    return fmt::format("{} with image {}",
                       script_.add_map(map.values, map.x_first, map.x_step, map.y_first, map.y_step),
                       few ? "pixels" : "");
  }

  /// Returns the element of the plot command that draws a layer.
  std::string element(Layer const& layer) {
    constexpr std::array markers{7, 5, 9, 11, 13, 4, 6, 8, 10, 12, 1, 2, 3};
    std::string const source = script_.add_table(layer.columns);
    std::string const title = layer.name.empty() ? "notitle" : "title " + quoted(layer.name);
    std::string const stroke =
        fmt::format("linewidth {} linecolor '{}'{}", layer.width, layer.colour, dash_type(layer.dash));
    std::string const points =
        layer.marker > 0 ? fmt::format(" pointtype {} pointsize {}",
                                       markers[static_cast<std::size_t>(layer.marker - 1) % markers.size()], layer.size)
                         : "";
    std::string const fill =
        fmt::format("fillstyle {} noborder linecolor '{}'",
                    layer.opacity < 1 ? fmt::format("transparent solid {}", layer.opacity) : std::string("solid 1.0"),
                    layer.colour);
    auto const drawn = [&](std::string_view how, std::string const& look) {
      return fmt::format("{} using {} {} {}", source, how, look, title);
    };
    switch (layer.kind) {
      case Layer::Kind::line:
        return drawn(points.empty() ? "1:2 with lines" : "1:2 with linespoints", stroke + points);
      case Layer::Kind::points:
        return drawn(points.empty() ? "1:2 with dots" : "1:2 with points", stroke + points);
      case Layer::Kind::errors:
        return drawn("1:2:3:4 with yerrorbars", stroke + points);
      case Layer::Kind::band:
        return drawn("1:2:3 with filledcurves", fill);
      case Layer::Kind::bars:
        return drawn("1:2:3 with boxes", fill);
      case Layer::Kind::levels:
        return drawn("1:2:3 with xerrorbars pointtype 0", stroke);
      case Layer::Kind::boxes:
        return drawn("1:3:1:2:3:4 with boxxyerror", fill);
      case Layer::Kind::arrows:
        return drawn("1:2:3:4 with vectors @arrow_heads", stroke);
      case Layer::Kind::spans:
        return drawn("1:2:3:4 with vectors @span_heads", stroke);
      case Layer::Kind::guides:
        break;
    }
    GLADSTONE_EXPECTS(!"guides are no element of the plot command");
    return {};
  }

  Figure const& figure_;
  GnuplotScript script_;
};

}  // namespace

void draw_figure(Figure const& figure, std::string const& path) { FigureScript(figure).write(path); }

}  // namespace gladstone::inline drawing
