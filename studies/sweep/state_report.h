#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "studies/sweep/run.h"

namespace gladstone::inline sweep {

/// Returns the state of a study as JSON: run; the counts cases, done, failed, missing and running (a running case also
/// counts as missing); failures [{case, title, error, again: the next run repeats it}]; missing_cases; running_cases.
nlohmann::ordered_json state_json(std::string const& run, Manifest const& cases, RunState const& state);

/// Returns the state as text: counts, the failed cases with their errors and the missing cases, at most 20 of each.
std::string state_text(std::string const& run, Manifest const& cases, RunState const& state);

}  // namespace gladstone::inline sweep
