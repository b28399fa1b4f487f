#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "studies/figures/study_drawings.h"

namespace gladstone {
namespace {

using namespace study_drawing;

/// One curve of a panel.
struct Curve {
  std::string name;
  std::string colour;
  bool dashed = false;
  std::vector<Scatter> points;  ///< one per position of the axis
};

struct Panel {
  std::string heading;
  std::vector<Curve> curves;
};

struct Reference {
  char const* measure;
  char const* name;
};
constexpr Reference references[] = {{"ray_truth.rms_px", "measured − ray truth"},
                                    {"eq9.rms_px", "measured − Eq. 9"},
                                    {"eq9_cone.rms_px", "measured − aperture-averaged Eq. 9"},
                                    {"window_truth.rms_px", "measured − ray truth on the window"}};
constexpr char const* signal = "signal_px";

/// Creates curves and accumulates the range of their values and the kind of their points.
struct CurveMaker {
  StudyCells const& cells;
  std::size_t axis;
  bool only_repeats_differ = true;
  std::size_t repeats = 0;
  double low = std::numeric_limits<double>::infinity(), high = 0;

  Curve operator()(std::string name, std::string_view colour, CurveChoice const& choice, char const* measure,
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

void plot_panel(GnuplotFigure& plot, FigureAxis const& axis, Panel const& panel) {
  std::string commands;
  auto const add = [&](std::string const& command) { commands += (commands.empty() ? "plot " : ", ") + command; };
  std::size_t solid = 0, seen = 0;
  for (Curve const& curve : panel.curves) solid += curve.dashed ? 0 : 1;
  for (Curve const& curve : panel.curves) {
    std::vector<std::vector<double>> columns(4);
    // For categories, shift the points of different curves sideways instead of connecting them.
    double const shift = axis.numeric ? 0.0 : 0.09 * (static_cast<double>(seen) - 0.5 * static_cast<double>(solid - 1));
    for (std::size_t i = 0; i < axis.size(); ++i) {
      columns[0].push_back(axis.position[i] + (curve.dashed && !axis.numeric ? 0.0 : shift));
      columns[1].push_back(curve.points[i].centre);
      columns[2].push_back(curve.points[i].low);
      columns[3].push_back(curve.points[i].high);
    }
    std::string const source = plot.add_table(columns);
    std::string const title =
        curve.name.empty() ? std::string("notitle") : "title " + GnuplotFigure::quoted(curve.name);
    if (curve.dashed && axis.numeric) {
      add(fmt::format("{} using 1:2 with lines linewidth 1.5 dashtype 2 linecolor '{}' {}", source, curve.colour,
                      title));
    } else if (curve.dashed) {
      add(fmt::format("{} using 1:2:(0.4) with xerrorbars pointtype 0 linewidth 1.5 dashtype 2 linecolor '{}' {}",
                      source, curve.colour, title));
    } else {
      if (axis.numeric) add(fmt::format("{} using 1:2 with lines linewidth 2 linecolor '{}'", source, curve.colour));
      add(fmt::format("{} using 1:2:3:4 with yerrorbars linewidth 1.6 pointtype 7 pointsize 0.8 linecolor '{}' {}",
                      source, curve.colour, title));
      ++seen;
    }
  }
  plot.command(commands);
}

/// Arranges panels side by side with a common title and error scale.
std::unique_ptr<GnuplotFigure> lay_out(FigureAxis const& axis, std::vector<Panel> const& panels, double low,
                                       double high, std::string const& title, std::string const& caption) {
  int const count = static_cast<int>(panels.size());
  double const width = count == 1 ? 660.0 : 500.0;
  std::size_t named = 0;
  for (Panel const& panel : panels) {
    auto const with_name = [](Curve const& curve) { return !curve.name.empty(); };
    named =
        std::max(named, static_cast<std::size_t>(std::count_if(panel.curves.begin(), panel.curves.end(), with_name)));
  }
  int const legend = 20 * static_cast<int>(named) + 8;
  int const below = room_below(axis, width) + 44;
  int const top = 44 + (count > 1 ? 28 : 0) + legend;
  auto figure = std::make_unique<GnuplotFigure>(static_cast<int>(count * (width + 96.0)) + 20, top + 360 + below);
  GnuplotFigure& plot = *figure;
  set_texts(plot, title, caption);
  plot.command("set multiplot");
  plot.command("set grid linecolor '#e4e4e4' linewidth 1 linetype 1");
  for (int i = 0; i < count; ++i) {
    double const left = 92.0 + i * (width + 96.0);
    plot.set_margins(left, left + width, top, plot.height_px() - below);
    set_x_axis(plot, axis, width);
    set_y_axis(plot, "rms per component [px]", low, high);
    if (count > 1) {
      plot.command(fmt::format("set label 4 {} at graph 0, screen {:.6f} left font 'DejaVu Sans Bold,11'",
                               GnuplotFigure::quoted(panels[static_cast<std::size_t>(i)].heading),
                               1.0 - 58.0 / plot.height_px()));
    }
    plot.command(fmt::format("set key at graph 0, screen {:.6f} left top Left reverse samplen 2 font 'DejaVu Sans,10'",
                             1.0 - (top - legend - 2.0) / plot.height_px()));
    plot_panel(plot, axis, panels[static_cast<std::size_t>(i)]);
    plot.command("unset label 1; unset label 2; unset label 3");
  }
  plot.command("unset multiplot");
  return figure;
}

}  // namespace

std::unique_ptr<GnuplotFigure> draw_error_curves(StudyCells const& cells, std::size_t axis_index) {
  FigureAxis const& axis = cells.axis(axis_index);
  std::vector<CurveChoice> const choices = curves_over(cells, axis_index, 7);
  CurveMaker make{cells, axis_index};
  std::vector<Panel> panels;
  std::string dashes;
  if (choices.size() == 1) {
    Panel panel{choices.front().name, {}};
    std::size_t colour = 0;
    for (Reference const& reference : references) {
      panel.curves.push_back(make(reference.name, house_colour(colour++), choices.front(), reference.measure));
    }
    panel.curves.push_back(make("signal: ray truth itself", "#404040", choices.front(), signal, true));
    panels.push_back(std::move(panel));
  } else {
    for (Reference const& reference : {references[0], references[1]}) {
      Panel panel{reference.name, {}};
      for (std::size_t i = 0; i < choices.size(); ++i) {
        panel.curves.push_back(make(choices[i].name, house_colour(i), choices[i], reference.measure));
      }
      for (std::size_t i = 0; i < choices.size(); ++i) {
        panel.curves.push_back(make("", house_colour(i), choices[i], signal, true));
      }
      panels.push_back(std::move(panel));
    }
    dashes = "; dashed: signal (rms of the ray truth)";
  }
  if (!(make.high > 0)) return nullptr;
  return lay_out(axis, panels, make.low, make.high, "Error against " + axis.title,
                 fmt::format("{}\n{}{}", study_name(cells), meaning(make.only_repeats_differ, make.repeats), dashes));
}

std::unique_ptr<GnuplotFigure> draw_repeats(StudyCells const& points, std::size_t axis_index) {
  FigureAxis const& axis = points.axis(axis_index);
  std::vector<CurveChoice> const choices = curves_over(points, axis_index, 7);
  CurveMaker make{points, axis_index};
  std::vector<Panel> panels;
  for (auto const& [error, name] : {std::pair{"ray_truth", references[0].name}, std::pair{"eq9", references[1].name}}) {
    Panel panel{name, {}};
    for (std::size_t i = 0; i < choices.size(); ++i) {
      std::string const curve = choices.size() > 1 ? choices[i].name : "the same in every repeat";
      panel.curves.push_back(make(curve, house_colour(i), choices[i], fmt::format("{}.systematic_px", error).c_str()));
    }
    for (std::size_t i = 0; i < choices.size(); ++i) {
      std::string const curve = choices.size() > 1 ? "" : "changes between repeats";
      panel.curves.push_back(
          make(curve, house_colour(i), choices[i], fmt::format("{}.scatter_px", error).c_str(), true));
    }
    panels.push_back(std::move(panel));
  }
  if (!(make.high > 0)) return nullptr;
  return lay_out(
      axis, panels, make.low, make.high, "Error over the repeats, against " + axis.title,
      fmt::format("study {}, {} points{}\nsolid: the same in every repeat; dashed: standard deviation between "
                  "repeats (dots, rays, noise)",
                  points.table().name, points.finished(), make.only_repeats_differ ? "" : ", medians of them"));
}

}  // namespace gladstone
