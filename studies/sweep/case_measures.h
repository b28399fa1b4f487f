#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <utility>
#include <vector>

#include "studies/case/write_case.h"
#include "studies/sweep/case_runner.h"

/// Measures of a case: the numbers in the columns of a study's table.
namespace gladstone::inline sweep {

/// Returns the numbers of errors.json by path ("budget.terms.cone.rms_px"), in its order. Null becomes NaN; arrays and
/// texts are omitted.
std::vector<std::pair<std::string, double>> flat_measures(nlohmann::ordered_json const& errors);

/// Adds the error over the signal and, for BOS with a camera on the Z axis, the error of the density gradient averaged
/// over the thickness, from measures that the result contains.
void add_relative_errors(Setup const& setup, CaseResult& result);

/// Adds the measures and warnings of a rendering to a result.
void add_rendering(PreparedCase const& prepared, RenderedCase const& rendered, RecordedFrames const& frames,
                   CaseResult& result);

}  // namespace gladstone::inline sweep
