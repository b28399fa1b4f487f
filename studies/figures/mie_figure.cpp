#include "studies/figures/mie_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/not_a_number.h"
#include "render/base/units.h"
#include "studies/figures/gnuplot.h"

namespace gladstone {
namespace {

/// Maximum number of decades; beyond it, ripples of the outer decades would be invisible.
constexpr int most_decades = 7;

/// Lines as columns of x and y, separated by NaN.
struct Polyline {
  std::vector<double> x, y;
  void polar(double radius, double degrees) {
    x.push_back(radius * std::cos(degrees * unit::degree));
    y.push_back(radius * std::sin(degrees * unit::degree));
  }
  void end() {
    x.push_back(not_a_number);
    y.push_back(not_a_number);
  }
};

/// Decades shown in a diagram: outermost circle and centre, as powers of ten.
struct Decades {
  int inner = -1, outer = 0;

  explicit Decades(ScatteringDiagram const& diagram) {
    double least = HUGE_VAL, most = 0;
    for (auto const* values : {&diagram.s1_squared, &diagram.s2_squared}) {
      for (double const value : *values) {
        most = std::max(most, value);
        if (value > 0) least = std::min(least, value);
      }
    }
    if (most <= 0) return;  // no scattered light
    outer = static_cast<int>(std::ceil(std::log10(most)));
    inner = std::clamp(static_cast<int>(std::floor(std::log10(least))), outer - most_decades, outer - 2);
  }
  int count() const { return outer - inner; }
  double radius(double value) const { return value > 0 ? std::max(0.0, std::log10(value) - inner) : 0.0; }
};

Polyline curve(Decades const& decades, std::vector<double> const& angle_deg, std::vector<double> const& values,
               double side) {
  Polyline line;
  for (std::size_t i = 0; i < values.size(); ++i) line.polar(decades.radius(values[i]), side * angle_deg[i]);
  return line;
}

/// Returns circles at the decades and spokes every 30 degrees.
Polyline paper(Decades const& decades) {
  Polyline lines;
  for (int decade = 1; decade <= decades.count(); ++decade) {
    for (int degrees = 0; degrees <= 360; degrees += 2) lines.polar(decade, degrees);
    lines.end();
  }
  for (int degrees = 0; degrees < 360; degrees += 30) {
    lines.polar(0, degrees);
    lines.polar(decades.count(), degrees);
    lines.end();
  }
  return lines;
}

void label(GnuplotFigure& plot, std::string const& text, double x, double y, std::string const& look) {
  plot.command(fmt::format("set label {} at first {:.6g},{:.6g} {}", GnuplotFigure::quoted(text), x, y, look));
}

}  // namespace

void write_mie_figure(std::string const& path, ScatteringDiagram const& diagram) {
  Decades const decades(diagram);
  double const rim = decades.count();
  constexpr int width = 760, height = 820;
  GnuplotFigure plot(width, height);
  plot.command("set style textbox opaque noborder margins 0.2,0.2");
  plot.command("unset border; unset tics; unset xlabel; unset ylabel; set size ratio -1");
  plot.command(
      "set lmargin at screen 0.03; set rmargin at screen 0.97; set tmargin at screen 0.87; set bmargin at screen 0.05");
  plot.command(fmt::format("set xrange [{0:.6g}:{1:.6g}]; set yrange [{0:.6g}:{1:.6g}]", -1.17 * rim, 1.17 * rim));
  MieEfficiencies const& q = diagram.efficiencies;
  std::string const index = diagram.m.imag() > 0 ? fmt::format("{:.6g} + {:.4g} i", diagram.m.real(), diagram.m.imag())
                                                 : fmt::format("{:.6g}", diagram.m.real());
  plot.command(fmt::format("set label {} at screen 0.5,0.955 center font 'DejaVu Sans,14' textcolor '#101010'",
                           GnuplotFigure::quoted(fmt::format("Sphere of x = {:.6g}, m = {}", diagram.x, index))));
  plot.command(
      fmt::format("set label {} at screen 0.5,0.92 center textcolor '#404040'",
                  GnuplotFigure::quoted(fmt::format("Q_ext = {:.5g}, Q_sca = {:.5g}, Q_back = {:.5g}, g = {:.5g}",
                                                    q.q_ext, q.q_sca, q.q_back, q.g))));
  for (int degrees = 0; degrees < 360; degrees += 30) {
    double const angle = degrees * unit::degree;
    label(plot, fmt::format("{}°", degrees <= 180 ? degrees : 360 - degrees), 1.07 * rim * std::cos(angle),
          1.07 * rim * std::sin(angle), "center font 'DejaVu Sans,10' textcolor '#606060'");
  }
  // labels of the decades along a spoke, away from the curves
  for (int decade = 1; decade <= decades.count(); ++decade) {
    double const angle = 75 * unit::degree;
    label(plot, fmt::format("1e{}", decades.inner + decade), decade * std::cos(angle), decade * std::sin(angle),
          "center front boxed font 'DejaVu Sans,9' textcolor '#606060'");
  }
  plot.command(fmt::format("set arrow from first {0:.6g},0 to first {1:.6g},0 front linewidth 2 linecolor '#202020'",
                           -0.99 * rim, -0.8 * rim));
  label(plot, "light", -0.9 * rim, 0.05 * rim, "center front textcolor '#202020'");

  Polyline const grid = paper(decades);
  Polyline const across = curve(decades, diagram.angle_deg, diagram.s1_squared, 1);
  Polyline const within = curve(decades, diagram.angle_deg, diagram.s2_squared, -1);
  plot.command("set key at screen 0.5,0.035 center horizontal Left reverse samplen 2 width -6");
  plot.command(fmt::format(
      "plot {} using 1:2 with lines linewidth 1 linecolor '#dcdcdc', {} using 1:2 with lines linewidth 2 linecolor "
      "'{}' "
      "title {}, {} using 1:2 with lines linewidth 2 linecolor '{}' title {}",
      plot.add_table({grid.x, grid.y}), plot.add_table({across.x, across.y}), house_colour(0),
      GnuplotFigure::quoted("|S1|² (above), field across the plane"), plot.add_table({within.x, within.y}),
      house_colour(1), GnuplotFigure::quoted("|S2|² (below), field in the plane")));
  plot.write(path);
}

}  // namespace gladstone
