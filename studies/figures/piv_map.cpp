#include "studies/figures/piv_map.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "studies/case/expected_particles.h"
#include "studies/figures/gnuplot.h"

namespace gladstone {
namespace {

constexpr std::array<double, 10> piv_f_numbers{1.4, 2, 2.8, 4, 5.6, 8, 11, 16, 22, 32};
constexpr double most_image_px = 4;  // F14

std::string own_stop(double f_number) {
  return fmt::format(
      "set arrow 1 from first {0:.6g},graph 0 to first {0:.6g},graph 1 nohead dashtype 2 linewidth 2 "
      "linecolor '{1}'",
      f_number, house_colour(1));
}

}  // namespace

std::vector<PivStop> piv_stops(Setup setup) {
  std::vector<PivStop> rows;
  for (double const stop : piv_f_numbers) {
    setup.lens.f_number = stop;
    ExpectedParticles const expected = expected_particles(setup);
    SizeSpread const& peak = expected.peak_electrons;
    rows.push_back(
        {stop, expected.image_diameter_px, expected.sheet_edge_diameter_px, {peak.p05, peak.median, peak.p95}});
  }
  return rows;
}

void write_piv_map(std::string const& path, Setup const& setup) {
  std::vector<double> f_number, image, edge, low, median, high;
  for (PivStop const& row : piv_stops(setup)) {
    f_number.push_back(row.f_number);
    image.push_back(row.image_px);
    edge.push_back(row.edge_px);
    low.push_back(row.peak_electrons[0]);
    median.push_back(row.peak_electrons[1]);
    high.push_back(row.peak_electrons[2]);
  }
  GnuplotFigure plot(900, 760);
  std::string tics;
  for (double const stop : piv_f_numbers) tics += fmt::format("{}'f/{:g}' {:g}", tics.empty() ? "" : ", ", stop, stop);
  plot.command("set multiplot layout 2,1");
  plot.command(fmt::format("set logscale xy; set xrange [{:g}:{:g}]; set xtics ({})", piv_f_numbers.front() / 1.05,
                           piv_f_numbers.back() * 1.05, tics));
  plot.command("set grid linecolor '#e4e4e4'; set key right bottom Left reverse samplen 2; set lmargin 12");
  plot.command(own_stop(setup.lens.f_number));
  plot.command("set title 'Particle images against the f-number' font 'DejaVu Sans,14'");
  plot.command("set ylabel 'e⁻² diameter of an image [px]'; set ytics (0.5, 1, 2, 3, 4, 5, 7, 10, 15, 20, 30, 50)");
  double const most = *std::max_element(edge.begin(), edge.end());
  plot.command(fmt::format("set yrange [{:.6g}:{:.6g}]",
                           std::min(1.0, 0.9 * *std::min_element(image.begin(), image.end())),
                           std::max(5.0, 1.2 * most)));
  plot.command(
      fmt::format("set object 1 rectangle from graph 0,first {:g} to graph 1,first {:g} fillcolor '#d8ecd8' "
                  "fillstyle solid noborder behind",
                  min_image_px, most_image_px));
  auto const line = [&](std::vector<double> const& y, std::string const& look, std::string const& title) {
    return fmt::format("{} using 1:2 with linespoints pointtype 7 {} title {}", plot.add_table({f_number, y}), look,
                       GnuplotFigure::quoted(title));
  };
  std::string const first = fmt::format("linewidth 2 linecolor '{}'", house_colour(0));
  plot.command("plot " + line(image, first, "in the middle of the sheet (2 to 4 px are suitable for correlation)") +
               ", " + line(edge, fmt::format("linewidth 2 dashtype 3 linecolor '{}'", house_colour(2)), "at its edge"));
  plot.command("unset title; unset object 1; set autoscale y; set ytics autofreq; set format y '%.0f'");
  plot.command("set key left bottom Left reverse samplen 2");
  plot.command(fmt::format("set xlabel 'f-number; the setup has f/{:g}'; set ylabel 'electrons at the peak'",
                           setup.lens.f_number));
  double const well = setup.camera.noise.full_well_e;
  plot.command(
      fmt::format("plot {} using 1:2:3 with filledcurves fillcolor '{}' fillstyle transparent solid 0.2 title {}, {}, "
                  "{:.6g} with lines linewidth 2 linecolor '{}' title {}",
                  plot.add_table({f_number, low, high}), house_colour(0),
                  GnuplotFigure::quoted("90 % of the particles"), line(median, first, "the median particle"), well,
                  house_colour(3), GnuplotFigure::quoted(fmt::format("full well, {:.6g}", well))));
  plot.command("unset multiplot");
  plot.write(path);
}

}  // namespace gladstone
