#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "studies/benchmark/benchmark_run.h"
#include "studies/case/json_text.h"
#include "studies/case/version_text.h"

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

}  // namespace gladstone::inline benchmarks
