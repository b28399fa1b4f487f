#pragma once

#include <vector>

#include "analysis/uncertainty/combination.h"
#include "studies/benchmark/benchmark_run.h"
#include "studies/case/backend.h"

namespace gladstone::inline benchmarks {

/// Measures the coverage of every uncertainty method with the default passes, on uniform displacement, shear, vortex
/// and refracted turbulence of 512 x 512 px at 1, 5 and 10 % noise. The seeds were not used to choose any parameter.
std::vector<CoverageRow> measure_coverage(int seeds, Backend const& device);

/// Fits the combination of uncertainty methods (analysis/uncertainty/combination.h) to the errors of the default
/// passes. The training set has 48 pairs of 512 x 512 px: uniform displacement, shear and stretch, at 1, 2, 5 and 10 %
/// noise, with particles of 2.2 to 4.5 px and 12 to 40 of them per 32 x 32 px. It contains no vortices and no
/// turbulence, on which measure_coverage() also evaluates it.
UncertaintyCombination learn_combination(Backend const& device);

}  // namespace gladstone::inline benchmarks
