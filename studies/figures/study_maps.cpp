#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "studies/figures/map_panels.h"
#include "studies/figures/study_drawings.h"

namespace gladstone {
namespace {

using namespace study_drawing;

/// Errors over two axes, as rows and columns of equal cells.
struct ErrorMap {
  char const* measure;
  char const* heading;
  std::vector<std::vector<double>> columns = std::vector<std::vector<double>>(3);  ///< x, y, error
};

/// Returns tics with the values' labels; cells have equal sizes on any scale.
std::string cell_tics(FigureAxis const& axis) {
  std::string tics;
  for (std::size_t i = 0; i < axis.size(); ++i) {
    tics += fmt::format("{}{} {}", i > 0 ? ", " : "", GnuplotFigure::quoted_tic(axis.label[i]), i);
  }
  return '(' + tics + ')';
}

std::size_t longest_label(FigureAxis const& axis) {
  std::size_t longest = 0;
  for (std::string const& label : axis.label) longest = std::max(longest, label.size());
  return longest;
}

/// Draws maps of errors over two axes, side by side.
class ErrorMapFigure {
 public:
  ErrorMapFigure(StudyCells const& cells, std::size_t x_axis, std::size_t y_axis)
      : cells_(cells), x_axis_(x_axis), y_axis_(y_axis), x_(cells.axis(x_axis)), y_(cells.axis(y_axis)) {
    for (ErrorMap& map : maps_) most_filled_ = std::max(most_filled_, fill(map));
    logarithmic_ = high_ > 10 * low_;
  }

  /// @return null if at most half of the cells have an error, since the axes vary together then
  std::unique_ptr<GnuplotFigure> draw() const {
    if (!(high_ > 0) || 2 * most_filled_ <= x_.size() * y_.size()) return nullptr;
    double const cell = x_.size() > 8 ? 50.0 : 62.0;
    double const width = std::max(240.0, cell * static_cast<double>(x_.size()));
    double const height = std::clamp(44.0 * static_cast<double>(y_.size()), 160.0, 480.0);
    double const left = 70.0 + 7.0 * static_cast<double>(longest_label(y_));
    int const below = room_below(x_, width) + 44;
    auto figure = std::make_unique<GnuplotFigure>(static_cast<int>(left + 2 * width + 140),
                                                  static_cast<int>(86 + height) + below);
    GnuplotFigure& plot = *figure;
    set_common_parts(plot, width);
    for (std::size_t m = 0; m < maps_.size(); ++m) {
      double const from = left + static_cast<double>(m) * (width + 26.0);
      plot.set_margins(from, from + width, 74, plot.height_px() - below);
      plot.command(fmt::format("set title {} font 'DejaVu Sans Bold,11' offset 0,-0.4",
                               GnuplotFigure::quoted(maps_[m].heading)));
      if (m == 0) {
        plot.command(fmt::format("set ylabel {}; set ytics {} font 'DejaVu Sans,10'; unset colorbox",
                                 GnuplotFigure::quoted(y_.title), cell_tics(y_)));
      } else {
        plot.command("unset ylabel; unset ytics");
        plot.command(
            fmt::format("set colorbox user origin screen {:.6f}, screen {:.6f} size screen {:.6f}, screen {:.6f}",
                        (from + width + 10.0) / plot.width_px(), below / static_cast<double>(plot.height_px()),
                        12.0 / plot.width_px(), (plot.height_px() - below - 74.0) / plot.height_px()));
      }
      draw_cells(plot, maps_[m].columns);
    }
    plot.command("unset multiplot");
    return figure;
  }

 private:
  /// Computes the errors of a map. @return number of cells with an error
  std::size_t fill(ErrorMap& map) {
    std::size_t filled = 0;
    for (std::size_t j = 0; j < y_.size(); ++j) {
      for (std::size_t i = 0; i < x_.size(); ++i) {
        std::vector<std::size_t> const rows = cells_.rows_at({{x_axis_, i}, {y_axis_, j}});
        bool const alone = cells_.only_repeats_differ(rows);
        double const error = compute_scatter(cells_.values(map.measure, rows), alone).centre;
        only_repeats_differ_ = only_repeats_differ_ && alone;
        repeats_ = std::max(repeats_, rows.size());
        map.columns[0].push_back(static_cast<double>(i));
        map.columns[1].push_back(static_cast<double>(j));
        map.columns[2].push_back(error);
        if (!std::isfinite(error)) continue;
        ++filled;
        if (error > 0) low_ = std::min(low_, error);
        high_ = std::max(high_, error);
      }
    }
    return filled;
  }

  /// Sets texts, colours and axes that both maps share. @param width  of a map [px]
  void set_common_parts(GnuplotFigure& plot, double width) const {
    set_texts(plot, fmt::format("Error over {} and {}", x_.title, y_.title),
              fmt::format("{}\n{}", study_name(cells_),
                          !only_repeats_differ_ ? "median of all cases of a cell"
                          : repeats_ > 1 ? fmt::format("root mean square over {} repeats; per component", repeats_)
                                         : std::string("single cases; rms per component")));
    plot.command("set multiplot");
    plot.command(sequential_palette());
    double const least = logarithmic_ ? low_ : 0.0;
    plot.command(fmt::format("{}set cbrange [{:.10g}:{:.10g}]", logarithmic_ ? "set logscale cb; " : "", least, high_));
    if (logarithmic_) plot.command("set cbtics " + logarithmic_tics(low_, high_));
    plot.command("set cbtics font 'DejaVu Sans,9' scale 0.3; set tics scale 0");
    plot.command(fmt::format("set xrange [-0.5:{:.1f}]; set yrange [-0.5:{:.1f}]", static_cast<double>(x_.size()) - 0.5,
                             static_cast<double>(y_.size()) - 0.5));
    plot.command(fmt::format("set xlabel {}", GnuplotFigure::quoted(x_.title)));
    bool const crowded = room_below(x_, width) > 56;
    plot.command(fmt::format("set xtics {} {} font 'DejaVu Sans,10'", crowded ? "rotate by 28 right" : "norotate",
                             cell_tics(x_)));
    plot.command(
        "set object 1 rectangle from graph 0,0 to graph 1,1 fillcolor '#b8b8b8' fillstyle solid noborder behind");
  }

  /// Draws the cells of a map, with their errors as numbers if there is room.
  void draw_cells(GnuplotFigure& plot, std::vector<std::vector<double>> const& columns) const {
    for (std::size_t k = 0; k < columns[2].size() && x_.size() <= 12 && y_.size() <= 12; ++k) {
      double const error = columns[2][k];
      if (!std::isfinite(error)) continue;
      double const share = logarithmic_ ? std::log(error / low_) / std::log(high_ / low_) : error / high_;
      plot.command(fmt::format("set label {} '{:.2g}' at {},{} center front font 'DejaVu Sans,9' textcolor '{}'",
                               10 + k, error, columns[0][k], columns[1][k], share > 0.6 ? "#101010" : "#f4f4f4"));
    }
    plot.command(fmt::format("plot {} using 1:2:(0.5):(0.5):3 with boxxyerror fillstyle solid 1.0 noborder palette",
                             plot.add_table(columns)));
    plot.command("unset label 1; unset label 2; unset label 3");
  }

  StudyCells const& cells_;
  std::size_t x_axis_, y_axis_;
  FigureAxis const& x_;
  FigureAxis const& y_;
  std::vector<ErrorMap> maps_{{"ray_truth.rms_px", "measured − ray truth [px]"},
                              {"eq9.rms_px", "measured − Eq. 9 [px]"}};
  bool only_repeats_differ_ = true, logarithmic_ = false;
  std::size_t repeats_ = 0, most_filled_ = 0;  ///< largest number of cases of a cell, and of cells with an error
  double low_ = std::numeric_limits<double>::infinity(), high_ = 0;  ///< range of the errors [px]
};

}  // namespace

std::unique_ptr<GnuplotFigure> draw_error_map(StudyCells const& cells, std::size_t x_axis, std::size_t y_axis) {
  return ErrorMapFigure(cells, x_axis, y_axis).draw();
}

}  // namespace gladstone
