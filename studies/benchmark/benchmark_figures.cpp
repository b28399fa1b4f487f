#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "studies/benchmark/benchmark_run.h"
#include "studies/figures/gnuplot.h"

namespace gladstone {
namespace {

/// Returns true for the default and the estimators that are only points of the curve of settings.
bool is_on_curve(std::string const& name) {
  for (BenchmarkEstimator const& one : benchmark_estimators())
    if (one.name == name) return one.of_curve || name == "default";
  return false;
}

/// Noise and gain of one estimator.
struct Point {
  std::string name;
  double gain = 0.0, rms = 0.0;
};

std::vector<Point> points_of(BenchmarkResult const& result) {
  std::map<std::string, BenchmarkRow const*> noise, gain;
  std::vector<std::string> order;
  for (BenchmarkRow const& row : result.rows) {
    if (row.of_case == noise_case) noise[row.estimator] = &row;
    if (row.of_case == gain_case) gain[row.estimator] = &row;
    if (std::find(order.begin(), order.end(), row.estimator) == order.end()) order.push_back(row.estimator);
  }
  std::vector<Point> points;
  for (std::string const& name : order) {
    if (!noise.contains(name) || !gain.contains(name)) continue;
    Point const point{name, gain[name]->score.gain, noise[name]->score.errors.rms_without_gross_px};
    if (std::isfinite(point.gain) && std::isfinite(point.rms)) points.push_back(point);
  }
  return points;
}

void draw_noise_against_gain(std::vector<Point> const& points, std::string const& path) {
  GnuplotFigure plot(900, 620);
  plot.command("set grid linecolor '#e4e4e4' linewidth 1 linetype 1");
  plot.command("set xlabel 'gain at sines of 64 px'; set ylabel 'rms error at 5 % noise, uniform displacement [px]'");
  plot.command("set key top left Left reverse samplen 2; set yrange [0:*]; set xrange [*:1.05]");
  plot.command("set title 'Noise against gain: better towards the lower right'");
  std::vector<Point> curve, others;
  for (Point const& point : points) (is_on_curve(point.name) ? curve : others).push_back(point);
  std::sort(curve.begin(), curve.end(), [](Point const& a, Point const& b) { return a.gain < b.gain; });
  std::string commands = "plot ";
  auto const columns_of = [](std::vector<Point> const& of) {
    std::vector<std::vector<double>> columns(2);
    for (Point const& point : of) {
      columns[0].push_back(point.gain);
      columns[1].push_back(point.rms);
    }
    return columns;
  };
  if (!curve.empty())
    commands +=
        fmt::format("{} using 1:2 with linespoints linewidth 2 pointtype 7 pointsize 1.1 linecolor '{}' title {}, ",
                    plot.add_table(columns_of(curve)), house_colour(0),
                    GnuplotFigure::quoted("our default with other last windows"));
  for (std::size_t i = 0; i < others.size(); ++i)
    commands += fmt::format("{} using 1:2 with points pointtype {} pointsize 1.6 linewidth 2 linecolor '{}' title {}, ",
                            plot.add_table(columns_of({others[i]})), 4 + i % 10, house_colour(1 + i % 5),
                            GnuplotFigure::quoted(others[i].name));
  for (std::size_t i = 0; i < curve.size(); ++i)
    plot.command(fmt::format("set label {} {} at {:.6g}, {:.6g} offset 0.6,-0.6 font 'DejaVu Sans,9'", i + 1,
                             GnuplotFigure::quoted(curve[i].name), curve[i].gain, curve[i].rms));
  commands.resize(commands.size() - 2);
  plot.command(commands);
  plot.write(path);
}

void draw_error_against_uncertainty(BenchmarkResult const& result, std::string const& path) {
  std::map<std::string, std::vector<std::vector<double>>> methods;
  for (UncertaintyRow const& row : result.uncertainties)
    for (UncertaintyBin const& bin : row.bins) {
      if (!(bin.rms_sigma_px > 0.0 && bin.rms_error_px > 0.0)) continue;
      auto& columns = methods[row.method];
      columns.resize(2);
      columns[0].push_back(bin.rms_sigma_px);
      columns[1].push_back(bin.rms_error_px);
    }
  GnuplotFigure plot(760, 680);
  plot.command("set grid linecolor '#e4e4e4' linewidth 1 linetype 1");
  plot.command("set logscale xy; set xrange [0.001:1]; set yrange [0.001:1]; set size square");
  plot.command(
      "set xlabel 'estimated uncertainty, rms(sigma) of a bin [px]'; set ylabel 'rms(error) of that bin [px]'");
  plot.command("set key top left Left reverse samplen 2");
  plot.command("set title 'Error against uncertainty, one point per tenth of a case: equal on the line'");
  std::string commands = "plot x with lines linewidth 1 dashtype 2 linecolor '#808080' notitle";
  std::size_t index = 0;
  for (auto const& [method, columns] : methods) {
    commands +=
        fmt::format(", {} using 1:2 with points pointtype {} pointsize 0.8 linecolor '{}' title {}",
                    plot.add_table(columns), 5 + 2 * (index % 5), house_colour(index), GnuplotFigure::quoted(method));
    ++index;
  }
  plot.command(commands);
  plot.write(path);
}

}  // namespace

std::vector<std::string> draw_benchmark(BenchmarkResult const& result, std::string const& folder) {
  std::vector<std::string> drawn;
  if (std::vector<Point> const points = points_of(result); !points.empty()) {
    drawn.emplace_back("noise_against_gain.png");
    draw_noise_against_gain(points, folder + '/' + drawn.back());
  }
  if (!result.uncertainties.empty()) {
    drawn.emplace_back("error_against_uncertainty.png");
    draw_error_against_uncertainty(result, folder + '/' + drawn.back());
  }
  return drawn;
}

}  // namespace gladstone
