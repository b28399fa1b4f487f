#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/compare/compare.h"

namespace gladstone::inline compare {

/// Formats the error measures and the error budget as text tables.
std::string error_report(Comparison const& comparison);

/// Returns error measures against ray_truth, eq9, eq9_cone (PIV: flow, ambient_truth) and window_truth, and the budget.
nlohmann::ordered_json compute_error_measures(Comparison const& comparison);

/// Returns compute_error_measures() as the text of errors.json.
std::string errors_json(Comparison const& comparison);

}  // namespace gladstone::inline compare
