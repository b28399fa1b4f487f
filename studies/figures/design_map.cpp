#include "studies/figures/design_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/units.h"
#include "studies/drawing/figure_texts.h"
#include "studies/figures/excluded_designs.h"

namespace gladstone::inline figures {
namespace {

using namespace plot;
using unit::mm;
constexpr std::array<double, 5> marked_z_d{0.1, 0.25, 0.5, 1, 2};  // Z_D of the lines in the map, relative to Z_A

std::vector<double> in_mm(std::vector<double> lengths) {
  for (double& length : lengths) length /= mm;
  return lengths;
}

struct Range2 {
  double low = HUGE_VAL, high = 0;
  void hold(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

std::string colour_of_stop(std::size_t index) {
  // light to dark blue, because f-numbers are ordered
  constexpr std::array<char const*, 8> shades{"#a6c8e4", "#86b5da", "#67a1cf", "#4a8cc2",
                                              "#3277b3", "#1f62a0", "#114c89", "#08366d"};
  return shades[index % shades.size()];
}

/// Returns the excluded areas, a pale colour for each limit.
std::vector<Layer> make_exclusions(std::vector<ExcludedDesigns> const& excluded) {
  constexpr std::array<char const*, 8> tints{"#f6cfc4", "#fbe6b8", "#d6e9c6", "#dcd3ee",
                                             "#e6dac6", "#c9e6e2", "#f3d3e4", "#dcdcdc"};
  constexpr double seam = 1.004;  // adjacent areas overlap: otherwise the edges between them are visible
  std::vector<Layer> layers;
  for (std::size_t i = 0; i < excluded.size(); ++i) {
    Layer layer{Layer::Kind::boxes, {{}, {}, {}, {}}, tints[i % tints.size()], "excluded: " + excluded[i].limit};
    for (MapArea const& area : excluded[i].areas) {
      layer.columns[0].push_back(area.least_sensitivity);
      layer.columns[1].push_back(area.most_sensitivity * seam);
      layer.columns[2].push_back(area.least_wavelength / mm);
      layer.columns[3].push_back(area.most_wavelength / mm);
    }
    layers.push_back(std::move(layer));
  }
  return layers;
}

/// Adds lines of constant Z_D with their labels.
void add_distances(Panel& panel, DesignPoint<double> const& bench) {
  for (double const share : marked_z_d) {
    std::vector<double> sensitivity, resolution;
    for (double const stop : map_f_numbers) {
      auto const one = design_on_map(bench, stop, share * bench.z_a);
      if (!one) continue;
      sensitivity.push_back(one->sensitivity());
      resolution.push_back(resolved_wavelength(*one) / mm);
    }
    if (sensitivity.empty()) continue;
    panel.labels.push_back({fmt::format("Z_D = {:.4g} mm", share * bench.z_a / mm), sensitivity.front(),
                            *std::max_element(resolution.begin(), resolution.end()), TextRole::fine_note, Align::right,
                            -5, -3});
    panel.layers.push_back({Layer::Kind::line, {std::move(sensitivity), std::move(resolution)}, "#b0b0b0", "", 1});
  }
}

}  // namespace

double map_z_d(DesignPoint<double> const& bench, double fraction) {
  return bench.z_a * 0.05 * std::pow(80.0, fraction);
}

std::optional<DesignPoint<double>> design_on_map(DesignPoint<double> const& bench, double f_number, double z_d) {
  DesignPoint<double> other = bench;
  other.f_number = f_number;
  other.z_d = z_d;
  if (other.z_b() < 1.05 * other.focal_length) return std::nullopt;
  other.dot_diameter = bench.geometric_dot_px() * other.pixel_at_dots();
  return other;
}

std::vector<DesignCurve> design_curves(DesignPoint<double> const& bench) {
  constexpr int points = 81;
  std::vector<DesignCurve> curves;
  for (double const stop : map_f_numbers) {
    DesignCurve curve{stop, {}, {}, {}, {}};
    for (int i = 0; i < points; ++i) {
      auto const one = design_on_map(bench, stop, map_z_d(bench, i / (points - 1.0)));
      if (!one) continue;
      curve.z_d.push_back(one->z_d);
      curve.sensitivity.push_back(one->sensitivity());
      curve.resolution.push_back(resolved_wavelength(*one));
      curve.cone.push_back(one->angular_sensitivity() / (stop * (1 + one->magnification())));
    }
    curves.push_back(std::move(curve));
  }
  return curves;
}

Figure make_design_map(DesignPoint<double> const& bench, DesignQuestion const* question) {
  Panel panel{.box = {70, 720, 56, 640}, .layers = make_exclusions(excluded_designs(bench, question))};
  std::vector<DesignCurve> const curves = design_curves(bench);
  Range2 x, y;
  for (std::size_t i = 0; i < curves.size(); ++i) {
    DesignCurve const& curve = curves[i];
    for (double const value : curve.sensitivity) x.hold(value);
    for (double const value : curve.resolution) y.hold(value / mm);
    panel.layers.push_back({Layer::Kind::line,
                            {curve.sensitivity, in_mm(curve.resolution)},
                            colour_of_stop(i),
                            fmt::format("f/{:g}", curve.f_number),
                            2.5});
    // the cone alone has a transfer of 1/sqrt(2) at the wavelength D_c / 0.51450
    std::vector<double> cone = in_mm(curve.cone);
    for (double& value : cone) value /= 0.51450;
    panel.layers.push_back({Layer::Kind::line,
                            {curve.sensitivity, std::move(cone)},
                            colour_of_stop(i),
                            i == curves.size() - 1 ? "light cone only: S/(N (1 + M)), F23" : "",
                            1,
                            Dash::dotted});
  }
  add_distances(panel, bench);
  panel.layers.push_back(
      {Layer::Kind::points, {{bench.sensitivity()}, {resolved_wavelength(bench) / mm}}, house_colour(1), "the setup"});
  panel.layers.back().marker = 1;
  panel.layers.back().size = 1.8;
  panel.x = {"sensitivity [px per kg/m⁴]", x.low / 1.1, x.high * 1.2, true};
  panel.y = {"wavelength transmitted with 1/√2 [mm]", y.low / 1.3, y.high * 1.3, true};
  panel.x.ticks = logarithmic_ticks(panel.x.low, panel.x.high);
  panel.y.ticks = logarithmic_ticks(panel.y.low, panel.y.high);
  panel.grid = Grid::both;
  panel.legend.place = LegendPlace::right;
  Figure figure{static_cast<int>(panel.box.right + legend_width(panel, Figure::Kind::chart)) + 12, 700};
  figure.add_title(fmt::format("Design map: f = {:.5g} mm, Z_A = {:.5g} mm", bench.focal_length / mm, bench.z_a / mm));
  figure.panels.push_back(std::move(panel));
  return figure;
}

Figure make_design_front(Recommendation const& answer, Objective objective) {
  constexpr std::array<char const*, 4> names{"smallest gradient [kg/m⁴]", "wavelength transmitted with 1/√2 [mm]",
                                             "random error [px]", "Z_A + Z_D [mm]"};
  constexpr std::array<double, 4> units{1, mm, 1, mm};
  auto const index = static_cast<std::size_t>(objective);
  Layer front{.columns = {{}, {}}, .colour = house_colour(0), .name = "best of all combinations", .marker = 1};
  for (FrontPoint const& point : answer.front) {
    front.columns[0].push_back(point.limit / answer.front_bound->unit);
    front.columns[1].push_back(point.objective / units[index]);
  }
  Figure figure{720, 520};
  figure.add_title("Trade-off between the requirements");
  figure.panels.push_back(
      {.box = {84, 696, 48, 460}, .x = {answer.front_bound->name}, .y = {names[index]}, .layers = {std::move(front)}});
  figure.panels.back().legend.place = LegendPlace::top_right;
  figure.panels.back().grid = Grid::both;
  return figure;
}

}  // namespace gladstone::inline figures
