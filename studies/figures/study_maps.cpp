#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "studies/drawing/figure_texts.h"
#include "studies/figures/study_drawings.h"

namespace gladstone::inline figures {
namespace {

using namespace plot;
using namespace study_drawing;

/// Errors over two axes, as rows and columns of equal cells.
struct ErrorMap {
  ErrorMeasure error;
  Image<double> errors = {};
};

/// Returns an axis of equally wide cells, one for each position, even if the positions have a logarithmic scale.
Axis make_cell_axis(FigureAxis const& axis) {
  std::vector<double> indices(axis.size());
  std::iota(indices.begin(), indices.end(), 0.0);
  return {axis.title,       -0.5, static_cast<double>(axis.size()) - 0.5, false, label_ticks(axis, indices),
          Axis::Marks::bare};
}

/// Draws maps of errors over two axes, side by side.
class ErrorMapFigure {
 public:
  ErrorMapFigure(StudyCells const& cells, std::size_t x_axis, std::size_t y_axis)
      : cells_(cells), x_axis_(x_axis), y_axis_(y_axis), x_(cells.axis(x_axis)), y_(cells.axis(y_axis)) {
    for (ErrorMeasure& error : known_errors(cells)) {
      if (maps_.size() == 2) break;
      maps_.push_back({std::move(error)});
      most_filled_ = std::max(most_filled_, fill(maps_.back()));
    }
    logarithmic_ = high_ > 10 * low_;
  }

  /// @return nullopt if at most half of the cells have an error, since the axes vary together then
  std::optional<Figure> make() const {
    if (!(high_ > 0) || 2 * most_filled_ <= x_.size() * y_.size()) return std::nullopt;
    double const cell = x_.size() > 8 ? 50.0 : 62.0;
    double const width = std::max(240.0, cell * static_cast<double>(x_.size()));
    double const height = std::clamp(44.0 * static_cast<double>(y_.size()), 160.0, 480.0);
    double longest = 0;
    for (std::string const& label : y_.label)
      longest = std::max(longest, text_width(label, font_of(Figure::Kind::chart, "tick")));
    double const left = 62.0 + longest, between = 40.0, count = static_cast<double>(maps_.size());
    int const below = room_below(x_, width) + 44;
    Figure figure{static_cast<int>(left + count * width + (count - 1) * between + 126),
                  static_cast<int>(86 + height) + below};
    add_texts(figure, fmt::format("Error over {} and {}", x_.title, y_.title),
              fmt::format("{}\n{}", study_name(cells_),
                          !only_repeats_differ_ ? "median of all cases of a cell"
                          : repeats_ > 1 ? fmt::format("root mean square over {} repeats; per component", repeats_)
                                         : std::string("single cases; rms per component")));
    for (std::size_t m = 0; m < maps_.size(); ++m) {
      double const from = left + static_cast<double>(m) * (width + between);
      Panel panel{.box = {from, from + width, 74, 86 + height - 12}, .title = maps_[m].error.name + " [px]"};
      panel.x = make_cell_axis(x_);
      panel.x.slanted = room_below(x_, width) > 56;
      panel.y = make_cell_axis(y_);
      if (m > 0) panel.y = {.low = panel.y.low, .high = panel.y.high, .marks = Axis::Marks::none};
      panel.map = Map{maps_[m].errors, 0, 1, 0, 1, Palette::sequential, logarithmic_ ? low_ : 0.0, high_, logarithmic_};
      panel.map->has_bar = m + 1 == maps_.size();
      if (logarithmic_) panel.map->ticks = logarithmic_ticks(low_, high_);
      if (x_.size() <= 12 && y_.size() <= 12) add_numbers(panel);
      figure.panels.push_back(std::move(panel));
    }
    return figure;
  }

 private:
  /// Computes the errors of a map. @return number of cells with an error
  std::size_t fill(ErrorMap& map) {
    std::size_t filled = 0;
    map.errors = Image<double>(static_cast<int>(x_.size()), static_cast<int>(y_.size()));
    for (std::size_t j = 0; j < y_.size(); ++j) {
      for (std::size_t i = 0; i < x_.size(); ++i) {
        std::vector<std::size_t> const rows = cells_.rows_at({{x_axis_, i}, {y_axis_, j}});
        bool const alone = cells_.only_repeats_differ(rows);
        double const error = compute_scatter(cells_.values(map.error.measure, rows), alone).centre;
        only_repeats_differ_ = only_repeats_differ_ && alone;
        repeats_ = std::max(repeats_, rows.size());
        map.errors(static_cast<int>(i), static_cast<int>(j)) = error;
        if (!std::isfinite(error)) continue;
        ++filled;
        if (error > 0) low_ = std::min(low_, error);
        high_ = std::max(high_, error);
      }
    }
    return filled;
  }

  /// Adds the errors as numbers to the cells.
  void add_numbers(Panel& panel) const {
    Image<double> const& errors = panel.map->values;
    for (int row = 0; row < errors.rows(); ++row) {
      for (int column = 0; column < errors.columns(); ++column) {
        double const error = errors(column, row);
        if (!std::isfinite(error)) continue;
        double const share = logarithmic_ ? std::log(error / low_) / std::log(high_ / low_) : error / high_;
        panel.labels.push_back({fmt::format("{:.2g}", error), static_cast<double>(column), static_cast<double>(row),
                                share > 0.6 ? TextRole::value_on_bright : TextRole::value_on_dark});
      }
    }
  }

  StudyCells const& cells_;
  std::size_t x_axis_, y_axis_;
  FigureAxis const& x_;
  FigureAxis const& y_;
  std::vector<ErrorMap> maps_;
  bool only_repeats_differ_ = true, logarithmic_ = false;
  std::size_t repeats_ = 0, most_filled_ = 0;  ///< largest number of cases of a cell, and of cells with an error
  double low_ = std::numeric_limits<double>::infinity(), high_ = 0;  ///< range of the errors [px]
};

}  // namespace

std::optional<Figure> make_error_map(StudyCells const& cells, std::size_t x_axis, std::size_t y_axis) {
  return ErrorMapFigure(cells, x_axis, y_axis).make();
}

}  // namespace gladstone::inline figures
