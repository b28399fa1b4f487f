#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/not_a_number.h"
#include "studies/figures/study_drawings.h"

namespace gladstone::inline figures {
namespace {

using namespace plot;
using namespace study_drawing;

/// A term of the budget with its rms at every position of the axis.
struct Term {
  std::string name;
  std::string colour;
  std::vector<double> rms;
};

/// Contributions below this fraction of the largest one are not shown [1].
constexpr double smallest_share = 1e-4;

std::vector<Term> terms_of(StudyTable const& table) {
  constexpr std::string_view start = "budget.terms.", end = ".rms_px";
  std::vector<Term> terms;
  for (std::string const& measure : table.measures) {
    if (!measure.starts_with(start) || !measure.ends_with(end)) continue;
    std::string const name = measure.substr(start.size(), measure.size() - start.size() - end.size());
    // Seventh colour; the grey of house_colour() is used for the total.
    bool const beyond = terms.size() >= 6;
    terms.push_back({name,
                     std::string(!beyond             ? house_colour(terms.size())
                                 : terms.size() == 6 ? "#f0e442"
                                                     : "#999999"),
                     {}});
  }
  return terms;
}

/// Draws the terms of the budget over an axis, in one panel for each curve.
class BudgetFigure {
 public:
  BudgetFigure(StudyCells const& cells, std::size_t axis_index, StudyCells const* points)
      : cells_(cells), points_(points), axis_index_(axis_index), axis_(cells.axis(axis_index)) {
    for (CurveChoice const& choice : choices_) panels_.push_back(collect_terms(choice));
    select_shown();
  }

  /// @return nullopt if no term has a value
  std::optional<Figure> make() const {
    if (!(high_ > 0)) return std::nullopt;
    auto const count = static_cast<double>(panels_.size());
    double const gap = count > 1 ? 46.0 : 0.0, top = 88.0 + (count > 1 ? 24.0 : 0.0);
    int const below = room_below(axis_, width_) + 44;
    Figure figure{static_cast<int>(width_) + 124, static_cast<int>(top + count * height + (count - 1) * gap) + below};
    add_texts(figure, "Error budget over " + axis_.title, caption());
    for (std::size_t p = 0; p < panels_.size(); ++p) {
      double const from = top + static_cast<double>(p) * (height + gap);
      if (!choices_[p].name.empty())
        figure.labels.push_back({choices_[p].name, 94, from - 14, TextRole::heading, Align::left});
      figure.panels.push_back(make_panel(p, from));
    }
    return figure;
  }

 private:
  /// Returns the terms and the total of a curve at every position of the axis.
  std::vector<Term> collect_terms(CurveChoice const& choice) {
    std::vector<Term> terms = terms_of(cells_.table());
    terms.push_back({"total", "#101010", {}});
    for (std::size_t place = 0; place < axis_.size(); ++place) {
      auto places = choice.places;
      places[axis_index_] = place;
      std::vector<std::size_t> const rows = cells_.rows_at(places);
      bool const alone = cells_.only_repeats_differ(rows);
      only_repeats_differ_ = only_repeats_differ_ && alone;
      repeats_ = std::max(repeats_, rows.size());
      for (Term& term : terms) {
        bool const of_points = points_ && (term.name == "estimator" || term.name == "pattern");
        std::vector<double> const values =
            of_points ? points_->values(fmt::format("budget.{}_px", term.name), points_->rows_at(places))
                      : values_of_cases(term.name, rows);
        term.rms.push_back(compute_scatter(values, alone).centre);
        if (std::isfinite(term.rms.back())) high_ = std::max(high_, term.rms.back());
      }
    }
    return terms;
  }

  /// Returns the rms of a term in some cases [px].
  std::vector<double> values_of_cases(std::string const& term, std::vector<std::size_t> const& rows) const {
    std::string const measure = term == "total" ? "budget.total.rms_px" : fmt::format("budget.terms.{}.rms_px", term);
    std::vector<double> values = cells_.values(measure, rows);
    if (points_) return values;
    // repeats only give the estimator's part for undeformed windows
    std::vector<double> const after = cells_.values(fmt::format("budget.after_passes.terms.{}.rms_px", term), rows);
    for (std::size_t i = 0; i < after.size() && i < values.size(); ++i) {
      if (std::isfinite(after[i])) values[i] = after[i];
    }
    return values;
  }

  /// Selects the terms with bars. Terms below the axis everywhere are named in the caption only.
  void select_shown() {
    for (std::size_t t = 0; t < panels_.front().size(); ++t) {
      double largest = 0;
      for (auto const& terms : panels_) {
        for (double const rms : terms[t].rms) {
          if (rms > smallest_share * high_) low_ = std::min(low_, rms);
          if (std::isfinite(rms)) largest = std::max(largest, rms);
        }
      }
      if (largest > smallest_share * high_) {
        shown_.push_back(t);
      } else {
        terms_below_axis_ += (terms_below_axis_.empty() ? "" : ", ") + spaced(panels_.front()[t].name);
      }
    }
    width_ = std::max(560.0, static_cast<double>(axis_.size()) * (static_cast<double>(shown_.size()) * 9.0 + 14.0));
  }

  std::string caption() const {
    return fmt::format("{}; {}{}\nthe terms are correlated: neither their heights nor their squares add up",
                       study_name(cells_),
                       !only_repeats_differ_ ? "medians of the cases"
                       : repeats_ > 1        ? fmt::format("root mean square over {} repeats", repeats_)
                                             : std::string("single cases"),
                       terms_below_axis_.empty() ? "" : "; below the axis: " + terms_below_axis_);
  }

  /// @param from  upper end of the panel [px]
  Panel make_panel(std::size_t p, double from) const {
    FigureAxis categories = axis_;
    categories.numeric = false;
    for (std::size_t i = 0; i < axis_.size(); ++i) categories.position[i] = static_cast<double>(i);
    Panel panel{.box = {94, 94 + width_, from, from + height}, .grid = Grid::horizontal};
    panel.x = make_x_axis(categories, width_);
    if (p + 1 < panels_.size()) panel.x = {.low = panel.x.low, .high = panel.x.high, .marks = Axis::Marks::none};
    panel.y = make_y_axis("rms per component [px]", low_, high_);
    if (p == 0) panel.legend = {LegendPlace::above, 46, true};
    double const bars = static_cast<double>(shown_.size());
    double const bar = 0.84 / bars;  // the bars at a position occupy 0.84 of the distance to the next
    for (std::size_t k = 0; k < shown_.size(); ++k) {
      Term const& term = panels_[p][shown_[k]];
      Layer layer{Layer::Kind::bars,
                  {{}, term.rms, std::vector<double>(axis_.size(), 0.9 * bar)},
                  term.colour,
                  spaced(term.name)};
      for (std::size_t i = 0; i < axis_.size(); ++i) {
        layer.columns[0].push_back(static_cast<double>(i) + bar * (static_cast<double>(k) - 0.5 * (bars - 1)));
        if (!(term.rms[i] > smallest_share * high_)) layer.columns[1][i] = not_a_number;
      }
      panel.layers.push_back(std::move(layer));
    }
    return panel;
  }

  /// Returns the name of a term with blanks instead of underscores.
  static std::string spaced(std::string name) {
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
  }

  static constexpr double height = 250.0;  ///< height of a panel [px]
  StudyCells const& cells_;
  StudyCells const* points_;
  std::size_t axis_index_;
  FigureAxis const& axis_;
  std::vector<CurveChoice> choices_ = curves_over(cells_, axis_index_, 3);
  std::vector<std::vector<Term>> panels_;  ///< terms of each curve
  std::vector<std::size_t> shown_;         ///< indices of the terms with bars
  std::string terms_below_axis_;           ///< names of the other terms, which are too small to be shown
  bool only_repeats_differ_ = true;
  std::size_t repeats_ = 0;                                          ///< largest number of cases of a value
  double low_ = std::numeric_limits<double>::infinity(), high_ = 0;  ///< range of the values [px]
  double width_ = 0;                                                 ///< width of the panels [px]
};

}  // namespace

std::optional<Figure> make_budget(StudyCells const& cells, std::size_t axis_index, StudyCells const* points) {
  return BudgetFigure(cells, axis_index, points).make();
}

}  // namespace gladstone::inline figures
