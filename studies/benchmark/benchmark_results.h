#pragma once

#include <string>
#include <vector>

#include "studies/benchmark/benchmark_run.h"

namespace gladstone::inline benchmarks {

/// Formats the results as JSON and as CSV.
std::string benchmark_json(BenchmarkResult const& result);
std::string benchmark_csv(BenchmarkResult const& result);

/// Draws noise_against_gain.png and error_against_uncertainty.png, as far as there are data. @return names of the drawn
/// files
std::vector<std::string> draw_benchmark(BenchmarkResult const& result, std::string const& folder);

}  // namespace gladstone::inline benchmarks
