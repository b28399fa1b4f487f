#pragma once

#include <optional>
#include <string>
#include <vector>

#include "analysis/correlation/correlation_settings.h"
#include "analysis/errors/uncertainty_quality.h"
#include "studies/benchmark/benchmark_score.h"
#include "studies/case/backend.h"

namespace gladstone::inline benchmarks {

/// Named correlation settings that the benchmark evaluates.
struct BenchmarkEstimator {
  std::string name;
  CorrelationSettings settings;
  /// True for points of the noise-gain curve; they only run on noise_case and gain_case.
  bool of_curve = false;
};

/// Returns all estimators of gladstone: the default, a single pass, other methods, and the curve of settings from
/// coarse to fine.
std::vector<BenchmarkEstimator> const& benchmark_estimators();

/// Returns true for the names of our estimators that are only points of the curve of settings.
bool is_of_curve(std::string const& name);

/// Vectors of external software: a folder of files named after the cases, or one such file.
struct ForeignVectors {
  std::string name, path;
  std::optional<std::string> conventions{};  ///< words of the user, see parse_conventions(); empty: those of the format
};

struct BenchmarkOptions {
  std::string folder;
  std::vector<std::string> cases;       ///< names of the cases to run; empty: all
  std::vector<std::string> estimators;  ///< names of gladstone's estimators to run; empty: all
  std::vector<ForeignVectors> vectors;
  int seeds = 0;  ///< number of seeds for the coverage; 0: skip the coverage
};

/// Score of one estimator on one case.
struct BenchmarkRow {
  std::string estimator, of_case;
  BenchmarkScore score;
  std::optional<double> seconds;  ///< computing time of gladstone's estimators [s]
};

/// Quality of an uncertainty method: estimated sigma against the errors of the default passes.
struct UncertaintyRow {
  std::string method, of_case;
  /// Relative to the window truth, to the deformed-window truth, which multi-pass correlation measures, and to the
  /// truth at the point (total error).
  UncertaintyQuality window, deformed_window, point;
  std::vector<UncertaintyBin> bins;  ///< estimated and actual errors by classes of sigma, relative to the truth at the
                                     ///< point
};

/// Mean over seeds and its standard error.
struct SeedMean {
  double mean = 0.0, error = 0.0;
};
/// Coverage of a method's sigma, averaged over seeds.
struct CoverageRow {
  std::string method, flow;
  double noise = 0.0;
  /// Fraction of the errors within sigma, relative to the truths of UncertaintyRow.
  SeedMean window, deformed_window, total;
  /// UncertaintyQuality::rms_ratio relative to the same truths
  SeedMean rms_ratio, rms_ratio_deformed_window, rms_ratio_total;
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
  std::vector<std::string> conventions;  ///< description of the conventions of each external code
  std::vector<std::string> mistakes;     ///< probable mistakes in the conventions of external files, one line each
  std::string device;
};

/// Images and truth of a case.
struct MadeCase {
  CaseRecord record;
  HostFrames frames;
  ParticlePair dots;  ///< particles or dots, without the images
  DisplacementAt truth;
  std::string setup;  ///< text of the setup if the images are ray-traced through turbulence; otherwise empty

  int columns() const { return frames.reference().columns(); }
  int rows() const { return frames.reference().rows(); }
};
/// Renders a case in memory.
MadeCase make_case(BenchmarkCase const& one, Backend const& device);

/// Name of the truth in a case's folder.
inline constexpr char const* benchmark_truth = "truth.csv";

/// Returns the paths of the files that run_benchmark() writes or removes in the folders of its cases.
std::vector<std::string> benchmark_case_files(BenchmarkOptions const& options);
/// Returns the paths of the external vector files that run_benchmark() reads.
/// @throws DataError if an external code has none
std::vector<std::string> foreign_vector_files(BenchmarkOptions const& options);

/// Creates the cases in FOLDER/CASE/, each with reference.tif, flow.tif and truth.csv, and scores vectors of gladstone
/// and of external software on them.
/// @throws DataError if an external file is unreadable, fits no conventions, or has repeated or missing vectors;
///         OutputError
BenchmarkResult run_benchmark(BenchmarkOptions const& options, Backend const& device);

/// True window displacements for the windows of the last pass, from the dots visible in both frames: window_truth() and
/// deformed_window_truth().
struct WindowTruths {
  std::vector<Vec2d> window, deformed_window;
};
WindowTruths compute_window_truths(DisplacementField const& field, ParticlePair const& dots,
                                   CorrelationSettings const& settings, int columns, int rows);

/// Names of the cases from which noise and gain are determined.
inline constexpr char const* noise_case = "noise_5";
inline constexpr char const* gain_case = "sine_64";

}  // namespace gladstone::inline benchmarks
