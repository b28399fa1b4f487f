#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/correlation/correlation_settings.h"
#include "analysis/errors/uncertainty_quality.h"
#include "analysis/uncertainty/combination.h"
#include "studies/benchmark/benchmark_score.h"
#include "studies/device.h"
#include "studies/report/report_page.h"

namespace gladstone {

/// One of our ways to measure, by its name in the benchmark.
struct BenchmarkEstimator {
  std::string name;
  CorrelationSettings settings;
  /// Part of the curve of settings: run where noise and gain are told from, and nowhere else.
  bool of_curve = false;
};

/// All of ours: the default, one pass, other methods, and the curve of settings from coarse to fine.
std::vector<BenchmarkEstimator> const& benchmark_estimators();

/// Vectors of another code: a folder of files named after cases, or one such file.
struct ForeignVectors {
  std::string name, path;
  std::optional<std::string> conventions{};  ///< as the user tells them; empty: the format's own
};

struct BenchmarkOptions {
  std::string folder;
  std::vector<std::string> cases;       ///< their names; empty: all
  std::vector<std::string> estimators;  ///< of ours; empty: all
  std::vector<ForeignVectors> vectors;
  int seeds = 0;  ///< of the coverage; 0: it is left out
};

/// A code's vectors against one case.
struct BenchmarkRow {
  std::string estimator, of_case;
  BenchmarkScore score;
  std::optional<double> seconds;  ///< that ours took
};

/// An uncertainty method's sigma against the errors of the default passes.
struct UncertaintyRow {
  std::string method, of_case;
  /// Against truth on the window, on the deformed window, which is what several passes measure, and at the point: the
  /// total error.
  UncertaintyQuality window, deformed_window, point;
  std::vector<UncertaintyBin> bins;  ///< against truth at the point
};

/// A mean over seeds with its standard error.
struct SeedMean {
  double mean = 0.0, error = 0.0;
};
/// Coverage of a method's sigma over many seeds.
struct CoverageRow {
  std::string method, flow;
  double noise = 0.0;
  SeedMean window, deformed_window, total;                         ///< coverage_1, as in UncertaintyRow
  SeedMean rms_ratio, rms_ratio_deformed_window, rms_ratio_total;  ///< likewise
};

struct CaseRecord {
  BenchmarkCase of;
  std::string reference_sha256, flow_sha256;
};

struct BenchmarkResult {
  std::vector<CaseRecord> cases;
  std::vector<BenchmarkRow> rows;
  std::vector<UncertaintyRow> uncertainties;
  std::vector<CoverageRow> coverage;
  int seeds = 0;
  std::vector<std::string> conventions;  ///< of each foreign code, in words
  std::vector<std::string> mistakes;     ///< likely ones of foreign codes, a line each
  std::string device;
};

/// Makes the cases, FOLDER/CASE/ with reference.tif, flow.tif and truth.csv each, and scores vectors on them: ours, and
/// those of others.
/// @throws DataError where a foreign file cannot be read, fits nothing, or has vectors twice or not at all; OutputError
BenchmarkResult run_benchmark(BenchmarkOptions const& options, Device const& device);

/// Truth on the windows of the last pass, of the dots that both frames show: window_truth() and
/// deformed_window_truth().
struct WindowTruths {
  std::vector<Vec2d> window, deformed_window;
};
WindowTruths window_truths_of(DisplacementField const& field, ParticlePair const& dots,
                              CorrelationSettings const& settings, int columns, int rows);

/// Coverage of every uncertainty method, default passes, over seeds that nothing was chosen on: uniform, shear, vortex
/// and refracted turbulence of 512 x 512 px at 1, 5 and 10 % noise.
std::vector<CoverageRow> measure_coverage(int seeds, Device const& device);

/// The combination of uncertainty methods (analysis/uncertainty/combination.h) that fits the errors of the default
/// passes best on uniform displacement, shear and stretch, at 1, 2, 5 and 10 % noise, particles of 2.2 to 4.5 px, 12 to
/// 40 of them in 32 x 32 px: 48 pairs of 512 x 512 px. Vortices and turbulence, on which measure_coverage() judges it
/// as well, it has never seen.
UncertaintyCombination learn_combination(Device const& device);

/// The page, and what it tells in numbers.
ReportPage benchmark_page(BenchmarkResult const& result, std::string const& folder);
std::string benchmark_json(BenchmarkResult const& result);
std::string benchmark_csv(BenchmarkResult const& result);
/// noise_against_gain.png and error_against_uncertainty.png: those that there is something to show in. @return names
std::vector<std::string> draw_benchmark(BenchmarkResult const& result, std::string const& folder);

/// Where noise and gain are told from.
inline constexpr char const* noise_case = "noise_5";
inline constexpr char const* gain_case = "sine_64";

}  // namespace gladstone
