#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "studies/sweep/run.h"

namespace gladstone {

/// How a study stands, as JSON: run, cases, done, failed, missing, running (counts; running are missing too),
/// failures [{case, title, error, again: whether the next run tries it again}], missing_cases, running_cases.
nlohmann::ordered_json state_json(std::string const& run, Manifest const& cases, RunState const& state);

/// The same to be read: counts, every failing case with its error, the first missing ones.
std::string state_text(std::string const& run, Manifest const& cases, RunState const& state);

}  // namespace gladstone
