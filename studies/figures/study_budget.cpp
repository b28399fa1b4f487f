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

}  // namespace

std::unique_ptr<GnuplotFigure> draw_budget(StudyCells const& cells, std::size_t axis_index, StudyCells const* points) {
  FigureAxis const& axis = cells.axis(axis_index);
  std::vector<CurveChoice> const choices = curves_over(cells, axis_index, 3);
  std::vector<std::vector<Term>> panels;
  bool only_repeats_differ = true;
  std::size_t repeats = 0;
  double low = std::numeric_limits<double>::infinity(), high = 0;
  for (CurveChoice const& choice : choices) {
    std::vector<Term> terms = terms_of(cells.table());
    terms.push_back({"total", "#101010", {}});
    for (std::size_t place = 0; place < axis.size(); ++place) {
      auto places = choice.places;
      places[axis_index] = place;
      std::vector<std::size_t> const rows = cells.rows_at(places);
      bool const alone = cells.only_repeats_differ(rows);
      only_repeats_differ = only_repeats_differ && alone;
      repeats = std::max(repeats, rows.size());
      for (Term& term : terms) {
        std::string const measure =
            term.name == "total" ? "budget.total.rms_px" : fmt::format("budget.terms.{}.rms_px", term.name);
        std::vector<double> values = cells.values(measure, rows);
        if (!points) {  // repeats only give the estimator's part for undeformed windows
          std::vector<double> const after =
              cells.values(fmt::format("budget.after_passes.terms.{}.rms_px", term.name), rows);
          for (std::size_t i = 0; i < after.size() && i < values.size(); ++i) {
            if (std::isfinite(after[i])) values[i] = after[i];
          }
        }
        if (points && (term.name == "estimator" || term.name == "pattern")) {
          values = points->values(fmt::format("budget.{}_px", term.name), points->rows_at(places));
        }
        term.rms.push_back(compute_scatter(values, alone).centre);
        if (std::isfinite(term.rms.back())) high = std::max(high, term.rms.back());
      }
    }
    panels.push_back(std::move(terms));
  }
  if (!(high > 0)) return nullptr;
  // Terms below the axis everywhere are named in the caption only.
  std::vector<std::size_t> shown;
  std::string nothing;
  for (std::size_t t = 0; t < panels.front().size(); ++t) {
    double largest = 0;
    for (auto const& terms : panels) {
      for (double const rms : terms[t].rms) {
        if (rms > smallest_share * high) low = std::min(low, rms);
        if (std::isfinite(rms)) largest = std::max(largest, rms);
      }
    }
    std::string name = panels.front()[t].name;
    std::replace(name.begin(), name.end(), '_', ' ');
    if (largest > smallest_share * high) {
      shown.push_back(t);
    } else {
      nothing += (nothing.empty() ? "" : ", ") + name;
    }
  }

  auto const count = static_cast<double>(panels.size());
  double const bars = static_cast<double>(shown.size());
  double const width = std::max(560.0, static_cast<double>(axis.size()) * (bars * 9.0 + 14.0));
  double const height = 250.0, gap = count > 1 ? 46.0 : 0.0;
  int const below = room_below(axis, width) + 44;
  double const top = 88.0 + (count > 1 ? 24.0 : 0.0);
  auto figure = std::make_unique<GnuplotFigure>(static_cast<int>(width) + 124,
                                                static_cast<int>(top + count * height + (count - 1) * gap) + below);
  GnuplotFigure& plot = *figure;
  set_texts(plot, "Error budget over " + axis.title,
            fmt::format("{}; {}{}\nthe terms are correlated: neither their heights nor their squares add up",
                        study_name(cells),
                        !only_repeats_differ ? "medians of the cases"
                        : repeats > 1        ? fmt::format("root mean square over {} repeats", repeats)
                                             : std::string("single cases"),
                        nothing.empty() ? "" : "; below the axis: " + nothing));
  plot.command("set multiplot");
  plot.command("set grid ytics linecolor '#e4e4e4' linewidth 1 linetype 1");
  plot.command("set style fill solid 1.0 noborder");
  // The bars at a position occupy 0.84 of the distance to the next.
  double const bar = 0.84 / bars;
  FigureAxis rows_of_bars = axis;
  rows_of_bars.numeric = false;
  for (std::size_t i = 0; i < axis.size(); ++i) rows_of_bars.position[i] = static_cast<double>(i);
  for (std::size_t p = 0; p < panels.size(); ++p) {
    double const from = top + static_cast<double>(p) * (height + gap);
    plot.set_margins(94, 94 + width, from, from + height);
    set_x_axis(plot, rows_of_bars, width);
    if (p + 1 < panels.size()) plot.command("unset xlabel; unset xtics");
    set_y_axis(plot, "rms per component [px]", low, high);
    if (!choices[p].name.empty()) {
      plot.command(fmt::format("set label 4 {} at graph 0, screen {:.6f} left font 'DejaVu Sans Bold,11'",
                               GnuplotFigure::quoted(choices[p].name), 1.0 - (from - 14.0) / plot.height_px()));
    }
    plot.command(p == 0 ? fmt::format("set key at graph 0, screen {:.6f} left top Left reverse horizontal samplen 1 "
                                      "width 1 maxrows 1 font 'DejaVu Sans,10'",
                                      1.0 - 46.0 / plot.height_px())
                        : std::string("unset key"));
    std::string commands;
    for (std::size_t k = 0; k < shown.size(); ++k) {
      Term const& term = panels[p][shown[k]];
      std::string name = term.name;
      std::replace(name.begin(), name.end(), '_', ' ');
      std::vector<double> x, rms = term.rms;
      for (std::size_t i = 0; i < axis.size(); ++i) {
        x.push_back(static_cast<double>(i) + bar * (static_cast<double>(k) - 0.5 * (bars - 1)));
        if (!(rms[i] > smallest_share * high)) rms[i] = std::numeric_limits<double>::quiet_NaN();
      }
      commands += fmt::format("{}{} using 1:2:({:.6f}) with boxes linecolor '{}' title {}", k > 0 ? ", " : "plot ",
                              plot.add_table({x, rms}), 0.9 * bar, term.colour, GnuplotFigure::quoted(name));
    }
    plot.command(commands);
    plot.command("unset label 1; unset label 2; unset label 3");
  }
  plot.command("unset multiplot");
  return figure;
}

}  // namespace gladstone
