#include "studies/figures/agreement_figure.h"

#include <fmt/format.h>

#include <cmath>

#include "render/base/contracts.h"
#include "studies/figures/gnuplot.h"

namespace gladstone {
namespace {

constexpr double smallest = 0.2, largest = 10;
constexpr int agreement_width = 1080, agreement_height = 470;

struct AgreementPanel {
  char const* title;
  double Agreement::*value;
  char const* key;
  int left, right;  ///< [px]
};
constexpr AgreementPanel panels[] = {
    {"correlation of light rays and Eq. 9", &Agreement::correlation, "bottom right", 62, 522},
    {"rms of light rays / rms of Eq. 9", &Agreement::rms_ratio, "top left", 604, 1064}};

void draw_panel(GnuplotFigure& plot, AgreementPanel const& panel, std::vector<AgreementSeries> const& series,
                std::vector<double> const& single_wave) {
  std::string commands = "plot ";
  if (!single_wave.empty()) {
    std::vector<std::vector<double>> columns(2);
    columns[0] = agreement_sizes();
    columns[1] = single_wave;
    commands += fmt::format("{} using 1:2 with lines linewidth 1.5 dashtype 2 linecolor '#808080' title {}, ",
                            plot.add_table(columns), GnuplotFigure::quoted("a single wave of that length"));
  }
  for (std::size_t i = 0; i < series.size(); ++i) {
    std::vector<std::vector<double>> line(2), points(4);
    for (auto const& prediction : series[i].prediction) {
      line[0].push_back(prediction.size_over_cone);
      line[1].push_back(prediction.value.*panel.value);
    }
    for (auto const& point : series[i].points) {
      points[0].push_back(point.size_over_cone);
      points[1].push_back(point.value.*panel.value);
      points[2].push_back(point.error.*panel.value);
      points[3].push_back(point.nodes);
    }
    std::string const table = plot.add_table(points);
    commands += fmt::format("{} using 1:2 with lines linewidth 2 linecolor '{}' title {}, ", plot.add_table(line),
                            house_colour(i), GnuplotFigure::quoted(series[i].name + ": theory"));
    commands +=
        fmt::format("{} using 1:2:3 with yerrorbars linewidth 1.6 pointtype {} pointsize 1.3 linecolor '{}' title {}, ",
                    table, i == 0 ? 7 : 5, house_colour(i), GnuplotFigure::quoted(series[i].name + ": rays"));
    // label the points, above one curve and below the other
    commands +=
        fmt::format("{} using 1:2:(sprintf('%d', $4)) with labels font 'DejaVu Sans,10' textcolor '{}' offset {}{}",
                    table, house_colour(i), i == 0 ? "-2.2,0.6" : "2.2,-0.6", i + 1 < series.size() ? ", " : "");
  }
  plot.command(commands);
}

}  // namespace

std::vector<double> agreement_sizes() {
  constexpr int steps = 100;
  std::vector<double> sizes;
  for (int i = 0; i <= steps; ++i) sizes.push_back(smallest * std::pow(largest / smallest, i / double(steps)));
  return sizes;
}

void write_agreement_figure(std::string const& path, std::vector<AgreementSeries> const& series,
                            std::vector<double> const& single_wave) {
  GLADSTONE_EXPECTS(!series.empty() && single_wave.size() == agreement_sizes().size());
  GnuplotFigure plot(agreement_width, agreement_height);
  plot.command("set multiplot");
  plot.command("set grid linecolor '#e4e4e4' linewidth 1 linetype 1");
  plot.command(fmt::format("set logscale x; set xrange [{}:{}]; set yrange [0:1.05]", smallest, largest));
  plot.command("set xtics (0.2, 0.5, 1, 2, 5, 10) font 'DejaVu Sans,11'; set ytics 0.2 font 'DejaVu Sans,11'");
  plot.command("set xlabel 'size of structures / width of the light cone at the medium' font 'DejaVu Sans,12'");
  for (AgreementPanel const& panel : panels) {
    plot.command(fmt::format("set lmargin at screen {:.6f}; set rmargin at screen {:.6f}",
                             panel.left / static_cast<double>(agreement_width),
                             panel.right / static_cast<double>(agreement_width)));
    plot.command("set tmargin at screen 0.91; set bmargin at screen 0.14");
    plot.command(
        fmt::format("set title {} font 'DejaVu Sans Bold,12' textcolor '#101010'", GnuplotFigure::quoted(panel.title)));
    plot.command(fmt::format("set key {} Left reverse samplen 2 spacing 1.15 font 'DejaVu Sans,10'", panel.key));
    bool const ratio = panel.value == &Agreement::rms_ratio;
    draw_panel(plot, panel, series, ratio ? single_wave : std::vector<double>{});
  }
  plot.command("unset multiplot");
  plot.write(path);
}

}  // namespace gladstone
