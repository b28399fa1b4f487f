#pragma once

#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "render/base/image.h"

namespace gladstone::inline drawing {

/// Parts of a figure as data. Positions on the page are in px from its upper left corner, all others in the units of
/// the axes. draw_figure() draws them with the look of the templates (*.gp).
namespace plot {

inline constexpr double automatic = std::numeric_limits<double>::quiet_NaN();

struct Tick {
  double at;
  std::string text;
};

struct Axis {
  std::string label = {};                    ///< title of the axis, with the unit
  double low = automatic, high = automatic;  ///< range; low > high: values decrease to the right, or upwards
  bool logarithmic = false;
  std::vector<Tick> ticks = {};  ///< ticks of the axis; empty: automatic
  enum class Marks { texts, ticks, bare, none };
  Marks marks = Marks::texts;  ///< ticks with texts, ticks only, texts only, or nothing
  bool slanted = false;        ///< true: texts of ticks are slanted, since they do not fit side by side
};

enum class Dash { solid, dashed, dotted };

/// Data drawn in one way. NaN interrupts lines and omits points.
struct Layer {
  enum class Kind {
    line,    ///< x, y; with a marker also the points
    points,  ///< x, y
    errors,  ///< x, y, low, high: points with error bars
    band,    ///< x, low, high
    bars,    ///< x, height, width: from y = 0
    levels,  ///< x, y, half width: horizontal lines
    boxes,   ///< lower x, upper x, lower y, upper y
    arrows,  ///< x, y, length in x, length in y
    spans,   ///< x, y, length in x, length in y: arrows with heads at both ends
    guides,  ///< x: vertical lines across the panel
  };
  Kind kind = Kind::line;
  std::vector<std::vector<double>> columns = {};
  std::string colour = "#404040";
  std::string name = {};  ///< name in the legend; empty: not listed there
  double width = 2;       ///< width of lines
  Dash dash = Dash::solid;
  int marker = 0;      ///< 0: none, -1: the smallest dot, from 1: circle, square, triangles, diamond, then hollow ones
  double size = 1;     ///< of the marker
  double opacity = 1;  ///< of areas
  std::vector<std::string> notes = {};  ///< of every point, shown at the pointer in a browser; empty: its coordinates
};

enum class Palette { diverging, sequential, grey };

/// Grid of values shown by colours, on grey for NaN; node (0, 0) at (x_first, y_first), steps of either sign.
struct Map {
  Image<double> values;
  double x_first = 0, x_step = 1, y_first = 0, y_step = 1;
  Palette palette = Palette::sequential;
  double low = 0, high = 1;  ///< values of the end colours
  bool logarithmic = false;
  bool has_bar = true;           ///< colour bar to the right of the panel
  std::vector<Tick> ticks = {};  ///< ticks of the colour bar; empty: automatic
};

enum class Align { left, centre, right };

/// Kind of a text, with its font and colour in the template.
enum class TextRole { title, subtitle, caption, heading, label, note, fine_note, value_on_dark, value_on_bright };

struct Label {
  std::string text;
  double x, y;  ///< position of the text's middle or end; on the page [px], or of a panel in the units of its axes
  TextRole role = TextRole::label;
  Align align = Align::centre;
  double right_px = 0, down_px = 0;  ///< shift [px]
  bool boxed = false;                ///< true: drawn in a box with a white background
  std::string colour = {};           ///< colour of the text; empty: that of the role
};

enum class LegendPlace { none, top_left, top_right, bottom_left, bottom_right, above, above_right, right, below };

struct Legend {
  LegendPlace place = LegendPlace::none;
  double top_px = 46;       ///< upper end on the page if it is above the panel
  bool horizontal = false;  ///< true: entries side by side
};

/// Place on the page [px].
struct Box {
  double left, right, top, bottom;
};

enum class Border { full, bottom, none };
enum class Grid { none, horizontal, both };

struct Panel {
  Box box = {};
  std::string title = {};
  Axis x = {}, y = {};
  std::optional<Map> map = {};
  std::vector<Layer> layers = {};  ///< layers, the lowest one first
  std::vector<Label> labels = {};  ///< moved if they overlap or leave the page, provided the axes have ranges
  Legend legend = {};
  Border border = Border::full;
  Grid grid = Grid::none;
  bool equal_scales = false;  ///< true: the same scale on both axes
};

}  // namespace plot

/// A figure as data.
struct Figure {
  int width_px = 820, height_px = 520;
  enum class Kind { chart, map, drawing };
  Kind kind = Kind::chart;  ///< selects the template
  std::vector<plot::Label> labels = {};
  std::vector<plot::Panel> panels = {};

  /// Adds the title in the middle of the upper edge.
  void add_title(std::string text) { labels.push_back({std::move(text), width_px / 2.0, 26, plot::TextRole::title}); }
};

/// A figure with the name of its file, or by which a reader chooses it.
struct NamedFigure {
  std::string name;
  Figure figure;
};

/// Returns a colour for lines and bars, distinguishable with a colour vision deficiency (Okabe & Ito 2008).
std::string house_colour(std::size_t index);

/// Returns ticks at multiples of a step of 1, 2 or 5 times a power of ten, at most `most` of them.
/// @pre low < high
std::vector<plot::Tick> linear_ticks(double low, double high, double most);

/// Returns ticks at 1, 2 and 5 times powers of ten, or at powers of ten only if the range exceeds three decades.
/// @pre 0 < low < high
std::vector<plot::Tick> logarithmic_ticks(double low, double high);

}  // namespace gladstone::inline drawing
