#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "studies/figures/study_drawings.h"

namespace gladstone {
namespace {

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

  /// @return null if no term has a value
  std::unique_ptr<GnuplotFigure> draw() {
    if (!(high_ > 0)) return nullptr;
    auto const count = static_cast<double>(panels_.size());
    double const gap = count > 1 ? 46.0 : 0.0, top = 88.0 + (count > 1 ? 24.0 : 0.0);
    int const below = room_below(axis_, width_) + 44;
    auto figure = std::make_unique<GnuplotFigure>(static_cast<int>(width_) + 124,
                                                  static_cast<int>(top + count * height + (count - 1) * gap) + below);
    GnuplotFigure& plot = *figure;
    set_texts(plot, "Error budget over " + axis_.title, caption());
    plot.command("set multiplot");
    plot.command("set grid ytics linecolor '#e4e4e4' linewidth 1 linetype 1");
    plot.command("set style fill solid 1.0 noborder");
    for (std::size_t p = 0; p < panels_.size(); ++p) draw_panel(plot, p, top + static_cast<double>(p) * (height + gap));
    plot.command("unset multiplot");
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
        nothing_ += (nothing_.empty() ? "" : ", ") + spaced(panels_.front()[t].name);
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
                       nothing_.empty() ? "" : "; below the axis: " + nothing_);
  }

  /// @param from  upper end of the panel [px]
  void draw_panel(GnuplotFigure& plot, std::size_t p, double from) const {
    FigureAxis rows_of_bars = axis_;
    rows_of_bars.numeric = false;
    for (std::size_t i = 0; i < axis_.size(); ++i) rows_of_bars.position[i] = static_cast<double>(i);
    plot.set_margins(94, 94 + width_, from, from + height);
    set_x_axis(plot, rows_of_bars, width_);
    if (p + 1 < panels_.size()) plot.command("unset xlabel; unset xtics");
    set_y_axis(plot, "rms per component [px]", low_, high_);
    if (!choices_[p].name.empty()) {
      plot.command(fmt::format("set label 4 {} at graph 0, screen {:.6f} left font 'DejaVu Sans Bold,11'",
                               GnuplotFigure::quoted(choices_[p].name), 1.0 - (from - 14.0) / plot.height_px()));
    }
    plot.command(p == 0 ? fmt::format("set key at graph 0, screen {:.6f} left top Left reverse horizontal samplen 1 "
                                      "width 1 maxrows 1 font 'DejaVu Sans,10'",
                                      1.0 - 46.0 / plot.height_px())
                        : std::string("unset key"));
    plot.command(bars_of(plot, panels_[p]));
    plot.command("unset label 1; unset label 2; unset label 3");
  }

  /// Adds the bars of a panel to the data. @return the command that plots them
  std::string bars_of(GnuplotFigure& plot, std::vector<Term> const& terms) const {
    double const bars = static_cast<double>(shown_.size());
    double const bar = 0.84 / bars;  // the bars at a position occupy 0.84 of the distance to the next
    std::string commands;
    for (std::size_t k = 0; k < shown_.size(); ++k) {
      Term const& term = terms[shown_[k]];
      std::vector<double> x, rms = term.rms;
      for (std::size_t i = 0; i < axis_.size(); ++i) {
        x.push_back(static_cast<double>(i) + bar * (static_cast<double>(k) - 0.5 * (bars - 1)));
        if (!(rms[i] > smallest_share * high_)) rms[i] = std::numeric_limits<double>::quiet_NaN();
      }
      commands +=
          fmt::format("{}{} using 1:2:({:.6f}) with boxes linecolor '{}' title {}", k > 0 ? ", " : "plot ",
                      plot.add_table({x, rms}), 0.9 * bar, term.colour, GnuplotFigure::quoted(spaced(term.name)));
    }
    return commands;
  }

  /// Returns the name of a term with blanks instead of underscores.
  static std::string spaced(std::string name) {
    std::replace(name.begin(), name.end(), '_', ' ');
    return name;
  }

  static constexpr double height = 250.0;  ///< of a panel [px]
  StudyCells const& cells_;
  StudyCells const* points_;
  std::size_t axis_index_;
  FigureAxis const& axis_;
  std::vector<CurveChoice> choices_ = curves_over(cells_, axis_index_, 3);
  std::vector<std::vector<Term>> panels_;  ///< terms of each curve
  std::vector<std::size_t> shown_;         ///< indices of the terms with bars
  std::string nothing_;                    ///< names of the other terms
  bool only_repeats_differ_ = true;
  std::size_t repeats_ = 0;                                          ///< largest number of cases of a value
  double low_ = std::numeric_limits<double>::infinity(), high_ = 0;  ///< range of the values [px]
  double width_ = 0;                                                 ///< of the panels [px]
};

}  // namespace

std::unique_ptr<GnuplotFigure> draw_budget(StudyCells const& cells, std::size_t axis_index, StudyCells const* points) {
  return BudgetFigure(cells, axis_index, points).draw();
}

}  // namespace gladstone
