#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "studies/figures/study_drawings.h"
#include "studies/figures/study_figures.h"

namespace gladstone::inline figures {
namespace {

using namespace plot;
using namespace study_drawing;

/// One curve of a panel.
struct Curve {
  std::string name;
  std::string colour;
  bool dashed = false;
  std::vector<Scatter> points;  ///< values of the curve, one per position of the axis
};

struct CurvePanel {
  std::string heading;
  std::vector<Curve> curves;
};

constexpr char const* error_label = "rms per component [px]";

/// Creates curves and accumulates the range of their values and the kind of their points.
struct CurveMaker {
  StudyCells const& cells;
  std::size_t axis;
  bool only_repeats_differ = true;
  std::size_t repeats = 0;
  double low = std::numeric_limits<double>::infinity(), high = 0;

  Curve operator()(std::string name, std::string_view colour, CurveChoice const& choice, std::string const& measure,
                   bool dashed = false) {
    Curve curve{std::move(name), std::string(colour), dashed, {}};
    for (std::size_t place = 0; place < cells.axis(axis).size(); ++place) {
      auto places = choice.places;
      places[axis] = place;
      std::vector<std::size_t> const rows = cells.rows_at(places);
      bool const alone = cells.only_repeats_differ(rows);
      only_repeats_differ = only_repeats_differ && alone;
      repeats = std::max(repeats, rows.size());
      Scatter const point = compute_scatter(cells.values(measure, rows), alone);
      if (point.low > 0) low = std::min(low, point.low);
      if (std::isfinite(point.high)) high = std::max(high, point.high);
      curve.points.push_back(point);
    }
    return curve;
  }
};

/// Returns the layers of a panel and its legend. For categories, the points of different curves are shifted sideways
/// instead of being connected.
std::vector<Layer> make_curve_layers(FigureAxis const& axis, CurvePanel const& panel) {
  auto const solid =
      std::count_if(panel.curves.begin(), panel.curves.end(), [](Curve const& one) { return !one.dashed; });
  std::vector<Layer> layers;
  double seen = 0;
  for (Curve const& curve : panel.curves) {
    double const shift = axis.numeric || curve.dashed ? 0.0 : 0.09 * (seen - 0.5 * static_cast<double>(solid - 1));
    std::vector<double> x, centre, low, high;
    for (std::size_t i = 0; i < axis.size(); ++i) {
      x.push_back(axis.position[i] + shift);
      centre.push_back(curve.points[i].centre);
      low.push_back(curve.points[i].low);
      high.push_back(curve.points[i].high);
    }
    Layer layer{.columns = {x, centre}, .colour = curve.colour};
    if (curve.dashed) {
      layer.width = 1.5;
      layer.dash = Dash::dashed;
      if (!axis.numeric) {
        layer.kind = Layer::Kind::levels;
        layer.columns.emplace_back(x.size(), 0.4);
      }
    } else {
      if (axis.numeric) layers.push_back(layer);
      layer = {Layer::Kind::errors, {x, centre, low, high}, curve.colour, "", 1.6};
      layer.marker = 1;
      layer.size = 0.8;
      ++seen;
    }
    layer.name = curve.name;
    layers.push_back(std::move(layer));
  }
  return layers;
}

/// Arranges panels side by side with a common title and y axis.
Figure lay_out(FigureAxis const& axis, std::vector<CurvePanel> const& panels, Axis const& y, std::string const& title,
               std::string const& caption) {
  int const count = static_cast<int>(panels.size());
  double const width = count == 1 ? 660.0 : 500.0;
  std::ptrdiff_t named = 0;
  for (CurvePanel const& panel : panels) {
    named = std::max(named, std::count_if(panel.curves.begin(), panel.curves.end(),
                                          [](Curve const& curve) { return !curve.name.empty(); }));
  }
  int const legend = 20 * static_cast<int>(named) + 8, below = room_below(axis, width) + 44;
  int const top = 44 + (count > 1 ? 28 : 0) + legend;
  Figure figure{static_cast<int>(count * (width + 96.0)) + 20, top + 360 + below};
  add_texts(figure, title, caption);
  for (int i = 0; i < count; ++i) {
    CurvePanel const& from = panels[static_cast<std::size_t>(i)];
    double const left = 92.0 + i * (width + 96.0);
    Panel panel{.box = {left, left + width, static_cast<double>(top), static_cast<double>(top + 360)}};
    panel.x = make_x_axis(axis, width);
    panel.y = y;
    panel.layers = make_curve_layers(axis, from);
    panel.grid = Grid::both;
    panel.legend = {LegendPlace::above, top - legend - 2.0};
    if (count > 1) figure.labels.push_back({from.heading, left, 58, TextRole::heading, Align::left});
    figure.panels.push_back(std::move(panel));
  }
  return figure;
}

}  // namespace

std::optional<Figure> make_error_curves(StudyCells const& cells, std::size_t axis_index) {
  FigureAxis const& axis = cells.axis(axis_index);
  std::vector<CurveChoice> const choices = curves_over(cells, axis_index, 7);
  CurveMaker make{cells, axis_index};
  std::vector<ErrorMeasure> const errors = known_errors(cells);
  std::vector<CurvePanel> panels;
  std::string dashes;
  if (choices.size() == 1) {
    CurvePanel panel{choices.front().name, {}};
    std::size_t colour = 0;
    for (ErrorMeasure const& error : errors)
      panel.curves.push_back(make(error.name, house_colour(colour++), choices.front(), error.measure));
    panel.curves.push_back(make("signal: ray truth itself", "#404040", choices.front(), signal_measure, true));
    panels.push_back(std::move(panel));
  } else {
    for (std::size_t k = 0; k < std::min<std::size_t>(2, errors.size()); ++k) {
      CurvePanel panel{errors[k].name, {}};
      for (std::size_t i = 0; i < choices.size(); ++i) {
        panel.curves.push_back(make(choices[i].name, house_colour(i), choices[i], errors[k].measure));
      }
      for (std::size_t i = 0; i < choices.size(); ++i) {
        panel.curves.push_back(make("", house_colour(i), choices[i], signal_measure, true));
      }
      panels.push_back(std::move(panel));
    }
    dashes = "; dashed: signal (rms of the ray truth)";
  }
  if (!(make.high > 0)) return std::nullopt;
  return lay_out(axis, panels, make_y_axis(error_label, make.low, make.high), "Error against " + axis.title,
                 fmt::format("{}\n{}{}", study_name(cells), meaning(make.only_repeats_differ, make.repeats), dashes));
}

std::optional<Figure> make_repeats(StudyCells const& points, std::size_t axis_index) {
  FigureAxis const& axis = points.axis(axis_index);
  std::vector<CurveChoice> const choices = curves_over(points, axis_index, 7);
  CurveMaker make{points, axis_index};
  std::vector<CurvePanel> panels;
  for (auto const& [error, name] :
       {std::pair{"ray_truth", "measured − ray truth"}, std::pair{"eq9", "measured − Eq. 9"}}) {
    CurvePanel panel{name, {}};
    for (std::size_t i = 0; i < choices.size(); ++i) {
      std::string const curve = choices.size() > 1 ? choices[i].name : "the same in every repeat";
      panel.curves.push_back(make(curve, house_colour(i), choices[i], fmt::format("{}.systematic_px", error)));
    }
    for (std::size_t i = 0; i < choices.size(); ++i) {
      std::string const curve = choices.size() > 1 ? "" : "changes between repeats";
      panel.curves.push_back(make(curve, house_colour(i), choices[i], fmt::format("{}.scatter_px", error), true));
    }
    panels.push_back(std::move(panel));
  }
  if (!(make.high > 0)) return std::nullopt;
  return lay_out(
      axis, panels, make_y_axis(error_label, make.low, make.high), "Error over the repeats, against " + axis.title,
      fmt::format("study {}, {} points{}\nsolid: the same in every repeat; dashed: standard deviation between "
                  "repeats (dots, rays, noise)",
                  points.table().name, points.finished(), make.only_repeats_differ ? "" : ", medians of them"));
}

std::optional<Figure> make_coverage(StudyCells const& cells, std::size_t axis_index) {
  constexpr double normal_coverage = 0.6827;  // of normal errors by their standard deviation
  FigureAxis const& axis = cells.axis(axis_index);
  std::vector<CurveChoice> const choices = curves_over(cells, axis_index, 7);
  CurveMaker make{cells, axis_index};
  CurvePanel panel;
  for (std::size_t i = 0; i < choices.size(); ++i) {
    panel.curves.push_back(
        make(choices.size() > 1 ? choices[i].name : "all cases", house_colour(i), choices[i], coverage_measure));
  }
  if (!(make.high > 0)) return std::nullopt;
  panel.curves.push_back({"68 %, as standard uncertainties of normal errors cover", "#404040", true,
                          std::vector<Scatter>(axis.size(), {normal_coverage, normal_coverage, normal_coverage})});
  return lay_out(axis, {panel}, {"fraction of the errors within their uncertainty", 0, 1},
                 "Coverage of the uncertainty against " + axis.title,
                 fmt::format("{}\n{}", study_name(cells), meaning(make.only_repeats_differ, make.repeats)));
}

}  // namespace gladstone::inline figures
