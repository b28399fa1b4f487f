#include <algorithm>
#include <cmath>
#include <map>

#include "studies/benchmark/benchmark_run.h"
#include "studies/drawing/draw_figure.h"

namespace gladstone::inline benchmarks {
namespace {

using namespace plot;

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
    Point const point{name, gain[name]->score.gain, noise[name]->score.errors["rms_without_gross_px"]};
    if (std::isfinite(point.gain) && std::isfinite(point.rms)) points.push_back(point);
  }
  return points;
}

Figure make_noise_against_gain(std::vector<Point> const& points) {
  Figure figure{900, 620};
  figure.add_title("Noise against gain: better towards the lower right");
  Panel panel{.box = {84, 876, 48, 556}, .grid = Grid::both};
  panel.x = {.label = "gain at sines of 64 px", .high = 1.05};
  panel.y = {.label = "rms error at 5 % noise, uniform displacement [px]", .low = 0};
  panel.legend.place = LegendPlace::top_left;
  std::vector<Point> curve, others;
  for (Point const& point : points) (is_on_curve(point.name) ? curve : others).push_back(point);
  std::sort(curve.begin(), curve.end(), [](Point const& a, Point const& b) { return a.gain < b.gain; });
  Layer line{.columns = {{}, {}}, .colour = house_colour(0), .name = "our default with other last windows"};
  line.marker = 1;
  line.size = 1.1;
  for (Point const& point : curve) {
    line.columns[0].push_back(point.gain);
    line.columns[1].push_back(point.rms);
    panel.labels.push_back({point.name, point.gain, point.rms, TextRole::fine_note, Align::left, 5, 10});
  }
  panel.layers.push_back(std::move(line));
  for (std::size_t i = 0; i < others.size(); ++i) {
    panel.layers.push_back(
        {Layer::Kind::points, {{others[i].gain}, {others[i].rms}}, house_colour(1 + i % 5), others[i].name});
    panel.layers.back().marker = static_cast<int>(2 + i);
    panel.layers.back().size = 1.6;
  }
  figure.panels.push_back(std::move(panel));
  return figure;
}

Figure make_error_against_uncertainty(BenchmarkResult const& result) {
  std::map<std::string, std::vector<std::vector<double>>> methods;
  for (UncertaintyRow const& row : result.uncertainties)
    for (UncertaintyBin const& bin : row.bins) {
      if (!(bin.rms_sigma_px > 0.0 && bin.rms_error_px > 0.0)) continue;
      auto& columns = methods[row.method];
      columns.resize(2);
      columns[0].push_back(bin.rms_sigma_px);
      columns[1].push_back(bin.rms_error_px);
    }
  Figure figure{760, 740};
  figure.add_title("Error against uncertainty, one point per tenth of a case: equal on the line");
  Panel panel{.box = {92, 720, 48, 676}, .grid = Grid::both};
  panel.x = {"estimated uncertainty, rms(sigma) of a bin [px]", 0.001, 1, true};
  panel.y = {"rms(error) of that bin [px]", 0.001, 1, true};
  panel.legend.place = LegendPlace::top_left;
  panel.layers.push_back({Layer::Kind::line, {{0.001, 1}, {0.001, 1}}, "#808080", "", 1, Dash::dashed});
  for (auto const& [method, columns] : methods) {
    std::size_t const index = panel.layers.size() - 1;
    panel.layers.push_back({Layer::Kind::points, columns, house_colour(index), method});
    panel.layers.back().marker = static_cast<int>(1 + index);
    panel.layers.back().size = 0.8;
  }
  figure.panels.push_back(std::move(panel));
  return figure;
}

}  // namespace

std::vector<std::string> draw_benchmark(BenchmarkResult const& result, std::string const& folder) {
  std::vector<std::string> drawn;
  if (std::vector<Point> const points = points_of(result); !points.empty()) {
    drawn.emplace_back("noise_against_gain.png");
    draw_figure(make_noise_against_gain(points), folder + '/' + drawn.back());
  }
  if (!result.uncertainties.empty()) {
    drawn.emplace_back("error_against_uncertainty.png");
    draw_figure(make_error_against_uncertainty(result), folder + '/' + drawn.back());
  }
  return drawn;
}

}  // namespace gladstone::inline benchmarks
