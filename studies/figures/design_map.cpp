#include "studies/figures/design_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/base/units.h"
#include "studies/figures/excluded_designs.h"
#include "studies/figures/gnuplot.h"

namespace gladstone {
namespace {

using unit::mm;
constexpr int map_width = 1180, map_height = 700;
constexpr std::array<double, 5> marked_z_d{0.1, 0.25, 0.5, 1, 2};  // relative to Z_A

std::vector<double> in_mm(std::vector<double> lengths) {
  for (double& length : lengths) length /= mm;
  return lengths;
}

/// Appends a data source, drawn with lines, to a plot command.
void add_line(GnuplotFigure& plot, std::string& command, std::vector<double> const& x, std::vector<double> const& y,
              std::string const& look, std::string const& title) {
  command += fmt::format("{}{} using 1:2 with {} {}", command.empty() ? "plot " : ", ", plot.add_table({x, y}), look,
                         title.empty() ? "notitle" : "title " + GnuplotFigure::quoted(title));
}

struct Range2 {
  double low = HUGE_VAL, high = 0;
  void hold(double value) {
    low = std::min(low, value);
    high = std::max(high, value);
  }
};

/// Returns tics of a logarithmic axis at 1, 2 and 5 of every decade.
std::string tics(double low, double high) {
  std::string list;
  for (double decade = std::pow(10.0, std::floor(std::log10(low))); decade <= high; decade *= 10) {
    for (double const digit : {1.0, 2.0, 5.0}) {
      double const at = digit * decade;
      if (at >= low && at <= high) list += fmt::format("{}{:.6g}", list.empty() ? "" : ", ", at);
    }
  }
  return list;
}

std::string colour_of_stop(std::size_t index) {
  // light to dark blue, because f-numbers are ordered
  constexpr std::array<char const*, 8> shades{"#a6c8e4", "#86b5da", "#67a1cf", "#4a8cc2",
                                              "#3277b3", "#1f62a0", "#114c89", "#08366d"};
  return shades[index % shades.size()];
}

/// Appends the excluded areas, a pale colour for each limit.
void add_exclusions(GnuplotFigure& plot, std::string& command, std::vector<ExcludedDesigns> const& excluded) {
  constexpr std::array<char const*, 8> tints{"#f6cfc4", "#fbe6b8", "#d6e9c6", "#dcd3ee",
                                             "#e6dac6", "#c9e6e2", "#f3d3e4", "#dcdcdc"};
  constexpr double seam = 1.004;  // adjacent areas overlap: otherwise the edges between them are visible
  for (std::size_t i = 0; i < excluded.size(); ++i) {
    std::vector<std::vector<double>> columns(4);
    for (MapArea const& area : excluded[i].areas) {
      columns[0].push_back(area.least_sensitivity);
      columns[1].push_back(area.most_sensitivity * seam);
      columns[2].push_back(area.least_wavelength / mm);
      columns[3].push_back(area.most_wavelength / mm);
    }
    command +=
        fmt::format("{}{} using 1:3:1:2:3:4 with boxxyerror fillstyle solid 1.0 noborder linecolor '{}' title {}",
                    command.empty() ? "plot " : ", ", plot.add_table(columns), tints[i % tints.size()],
                    GnuplotFigure::quoted("excluded: " + excluded[i].limit));
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

void write_design_map(std::string const& path, DesignPoint<double> const& bench, DesignQuestion const* question) {
  std::vector<DesignCurve> const curves = design_curves(bench);
  GnuplotFigure plot(map_width, map_height);
  Range2 x, y;
  std::string command;
  add_exclusions(plot, command, excluded_designs(bench, question));
  for (std::size_t i = 0; i < curves.size(); ++i) {
    DesignCurve const& curve = curves[i];
    for (double const value : curve.sensitivity) x.hold(value);
    for (double const value : curve.resolution) y.hold(value / mm);
    std::string const colour = colour_of_stop(i);
    add_line(plot, command, curve.sensitivity, in_mm(curve.resolution),
             fmt::format("lines linewidth 2.5 linecolor '{}'", colour), fmt::format("f/{:g}", curve.f_number));
    // the cone alone has a transfer of 1/sqrt(2) at the wavelength D_c / 0.51450
    std::vector<double> cone = in_mm(curve.cone);
    for (double& value : cone) value /= 0.51450;
    add_line(plot, command, curve.sensitivity, cone, fmt::format("lines linewidth 1 dashtype 3 linecolor '{}'", colour),
             i == curves.size() - 1 ? "light cone only: S/(N (1 + M)), F23" : "");
  }
  for (double const share : marked_z_d) {
    std::vector<double> sensitivity, resolution;
    for (double const stop : map_f_numbers) {
      auto const one = design_on_map(bench, stop, share * bench.z_a);
      if (!one) continue;
      sensitivity.push_back(one->sensitivity());
      resolution.push_back(resolved_wavelength(*one) / mm);
    }
    if (sensitivity.empty()) continue;
    add_line(plot, command, sensitivity, resolution, "lines linewidth 1 linecolor '#b0b0b0'", "");
    plot.command(fmt::format(
        "set label {} at first {:.6g},{:.6g} right offset -0.6,0.2 font 'DejaVu Sans,9' textcolor '#707070'",
        GnuplotFigure::quoted(fmt::format("Z_D = {:.4g} mm", share * bench.z_a / mm)), sensitivity.front(),
        *std::max_element(resolution.begin(), resolution.end())));
  }
  double const x_low = x.low / 1.1, x_high = x.high * 1.2, y_low = y.low / 1.3, y_high = y.high * 1.3;
  add_line(plot, command, {bench.sensitivity()}, {resolved_wavelength(bench) / mm},
           fmt::format("points pointtype 7 pointsize 1.8 linecolor '{}'", house_colour(1)), "the setup");
  plot.command(fmt::format("set title {} font 'DejaVu Sans,14'",
                           GnuplotFigure::quoted(fmt::format("Design map: f = {:.5g} mm, Z_A = {:.5g} mm",
                                                             bench.focal_length / mm, bench.z_a / mm))));
  plot.command("set xtics (" + tics(x_low, x_high) + "); set ytics (" + tics(y_low, y_high) + ")");
  plot.command(
      "set logscale xy; set grid linecolor '#e4e4e4'; set key outside right top Left reverse samplen 2 width -4");
  plot.command("set xlabel 'sensitivity [px per kg/m⁴]'; set ylabel 'wavelength transmitted with 1/√2 [mm]'");
  plot.command(fmt::format("set xrange [{:.6g}:{:.6g}]; set yrange [{:.6g}:{:.6g}]", x_low, x_high, y_low, y_high));
  plot.command(command);
  plot.write(path);
}

void write_design_front(std::string const& path, Recommendation const& answer, Objective objective) {
  constexpr std::array<char const*, 4> names{"smallest gradient [kg/m⁴]", "wavelength transmitted with 1/√2 [mm]",
                                             "random error [px]", "Z_A + Z_D [mm]"};
  constexpr std::array<double, 4> units{1, mm, 1, mm};
  auto const index = static_cast<std::size_t>(objective);
  BoundKey const key = bound_key(answer.front_bound);
  std::vector<double> x, y;
  for (FrontPoint const& point : answer.front) {
    x.push_back(point.limit / key.unit);
    y.push_back(point.objective / units[index]);
  }
  GnuplotFigure plot(720, 520);
  plot.command(
      fmt::format("set title {} font 'DejaVu Sans,14'", GnuplotFigure::quoted("Trade-off between the requirements")));
  plot.command("set grid linecolor '#e4e4e4'");
  plot.command(fmt::format("set xlabel {}; set ylabel {}", GnuplotFigure::quoted(key.path),
                           GnuplotFigure::quoted(names[index])));
  std::string command;
  add_line(plot, command, x, y, fmt::format("linespoints pointtype 7 linewidth 2 linecolor '{}'", house_colour(0)),
           "best of all combinations");
  plot.command(command);
  plot.write(path);
}

}  // namespace gladstone
