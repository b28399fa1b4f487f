#include "studies/benchmark/benchmark_results.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "studies/case/backend.h"
#include "studies/case/json_text.h"
#include "studies/drawing/draw_figure.h"

namespace gladstone::inline benchmarks {
namespace {

bool is_whole(std::string_view measure) {
  return measure == "vectors" || measure == "count" || measure == "gross" || measure == "without_sigma";
}

nlohmann::json number(std::string_view measure, double value) {
  return is_whole(measure) ? nlohmann::json(static_cast<long long>(value)) : number_or_null(value);
}

nlohmann::ordered_json quality_json(UncertaintyQuality const& quality) {
  nlohmann::ordered_json json;
  for (auto const& [name, value] : quality_measures(quality)) json[std::string(name)] = number(name, value);
  return json;
}

nlohmann::ordered_json mean_json(SeedMean const& mean) {
  return {{"mean", number_or_null(mean.mean)}, {"standard_error", number_or_null(mean.error)}};
}

using namespace plot;

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
  for (Point const& point : points)
    (point.name == "default" || is_of_curve(point.name) ? curve : others).push_back(point);
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

std::string benchmark_json(BenchmarkResult const& result) {
  nlohmann::ordered_json json;
  json["software"] = build_text();
  json["device"] = result.device;
  for (char const* part : {"cases", "scores", "uncertainty", "coverage"}) json[part] = nlohmann::ordered_json::array();
  for (CaseRecord const& one : result.cases) {
    ParticleSettings const& p = one.of.particles;
    json["cases"].push_back({{"case", one.of.name},
                             {"what", one.of.what},
                             {"columns", p.columns},
                             {"rows", p.rows},
                             {"seed", p.seed},
                             {"noise", p.noise},
                             {"reference_sha256", one.reference_sha256},
                             {"flow_sha256", one.flow_sha256}});
  }
  for (BenchmarkRow const& row : result.rows) {
    nlohmann::ordered_json one{{"estimator", row.estimator}, {"case", row.of_case}};
    for (auto const& [name, value] : score_measures(row.score)) one[std::string(name)] = number(name, value);
    one["seconds"] = row.seconds ? nlohmann::json(*row.seconds) : nlohmann::json(nullptr);
    json["scores"].push_back(one);
  }
  for (UncertaintyRow const& row : result.uncertainties) {
    nlohmann::ordered_json one{{"method", row.method},
                               {"case", row.of_case},
                               {"window_truth", quality_json(row.window)},
                               {"deformed_window_truth", quality_json(row.deformed_window)},
                               {"point_truth", quality_json(row.point)},
                               {"bins", nlohmann::ordered_json::array()}};
    for (UncertaintyBin const& bin : row.bins)
      one["bins"].push_back(
          {{"count", bin.count}, {"rms_sigma_px", bin.rms_sigma_px}, {"rms_error_px", bin.rms_error_px}});
    json["uncertainty"].push_back(one);
  }
  for (CoverageRow const& row : result.coverage)
    json["coverage"].push_back({{"method", row.method},
                                {"flow", row.flow},
                                {"noise", row.noise},
                                {"seeds", result.seeds},
                                {"coverage_1_window", mean_json(row.window)},
                                {"coverage_1_deformed_window", mean_json(row.deformed_window)},
                                {"coverage_1_total", mean_json(row.total)},
                                {"rms_ratio_window", mean_json(row.rms_ratio)},
                                {"rms_ratio_deformed_window", mean_json(row.rms_ratio_deformed_window)},
                                {"rms_ratio_total", mean_json(row.rms_ratio_total)}});
  json["conventions"] = result.conventions;
  json["likely_mistakes"] = result.mistakes;
  return json_text(json) + '\n';
}

std::string benchmark_csv(BenchmarkResult const& result) {
  std::string text = "estimator,case";
  for (auto const& [name, value] : score_measures({})) text += fmt::format(",{}", name);
  text += ",seconds\n";
  for (BenchmarkRow const& row : result.rows) {
    text += row.estimator + ',' + row.of_case;
    for (auto const& [name, value] : score_measures(row.score)) text += fmt::format(",{:.6g}", value);
    text += row.seconds ? fmt::format(",{:.4g}\n", *row.seconds) : ",nan\n";
  }
  return text;
}

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
