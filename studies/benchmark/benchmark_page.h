#pragma once

#include <string>

#include "studies/benchmark/benchmark_run.h"
#include "studies/report/report_page.h"

namespace gladstone::inline benchmarks {

/// Formats the results as a report page.
ReportPage benchmark_page(BenchmarkResult const& result, std::string const& folder);

}  // namespace gladstone::inline benchmarks
