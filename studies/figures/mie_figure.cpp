#include "studies/figures/mie_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/not_a_number.h"
#include "render/base/units.h"

namespace gladstone::inline figures {
namespace {

using namespace plot;

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

}  // namespace

Figure make_mie_figure(ScatteringDiagram const& diagram) {
  Decades const decades(diagram);
  double const rim = decades.count();
  Figure figure{760, 820, Figure::Kind::drawing};
  MieEfficiencies const& q = diagram.efficiencies;
  std::string const index = diagram.m.imag() > 0 ? fmt::format("{:.6g} + {:.4g} i", diagram.m.real(), diagram.m.imag())
                                                 : fmt::format("{:.6g}", diagram.m.real());
  figure.add_title(fmt::format("Sphere of x = {:.6g}, m = {}", diagram.x, index));
  figure.labels.push_back(
      {fmt::format("Q_ext = {:.5g}, Q_sca = {:.5g}, Q_back = {:.5g}, g = {:.5g}", q.q_ext, q.q_sca, q.q_back, q.g),
       figure.width_px / 2.0, 62, TextRole::subtitle});
  Panel panel{.box = {23, 737, 76, 790}, .legend = {LegendPlace::below, 0, true}, .border = Border::none};
  panel.x = panel.y = {.low = -1.17 * rim, .high = 1.17 * rim, .marks = Axis::Marks::none};
  for (int degrees = 0; degrees < 360; degrees += 30) {
    double const angle = degrees * unit::degree;
    panel.labels.push_back({fmt::format("{}°", degrees <= 180 ? degrees : 360 - degrees), 1.07 * rim * std::cos(angle),
                            1.07 * rim * std::sin(angle), TextRole::note});
  }
  // labels of the decades along a spoke, away from the curves
  for (int decade = 1; decade <= decades.count(); ++decade) {
    double const angle = 75 * unit::degree;
    panel.labels.push_back({fmt::format("1e{}", decades.inner + decade), decade * std::cos(angle),
                            decade * std::sin(angle), TextRole::fine_note});
    panel.labels.back().boxed = true;
  }
  panel.labels.push_back({"light", -0.9 * rim, 0.05 * rim});
  auto const add = [&panel](Polyline line, std::string const& colour, double width, char const* name) {
    panel.layers.push_back({Layer::Kind::line, {std::move(line.x), std::move(line.y)}, colour, name, width});
  };
  add(paper(decades), "#dcdcdc", 1, "");
  add(curve(decades, diagram.angle_deg, diagram.s1_squared, 1), house_colour(0), 2,
      "|S1|² (above), field across the plane");
  add(curve(decades, diagram.angle_deg, diagram.s2_squared, -1), house_colour(1), 2,
      "|S2|² (below), field in the plane");
  panel.layers.push_back({Layer::Kind::arrows, {{-0.99 * rim}, {0}, {0.19 * rim}, {0}}, "#202020"});
  figure.panels.push_back(std::move(panel));
  return figure;
}

}  // namespace gladstone::inline figures
