#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/setup/setup_table.h"
#include "studies/case/backend.h"
#include "studies/case/result_rows.h"
#include "studies/design/verification.h"

namespace gladstone {

/// Request to `gladstone design`.
struct DesignRequest {
  std::string setup;
  std::vector<std::string> overrides;
  std::string figures;  ///< folder of the figures; empty: no figures
  std::string figure_format = "png";
  std::string apply;                     ///< file for the recommended setup; empty: not written
  VerificationPlan verification;         ///< extent of the simulation; benches = 0: none
  std::function<Backend()> open_device;  ///< opens the device of the simulation
};

/// Result of `gladstone design`.
struct DesignReport {
  nlohmann::ordered_json json;
  std::string text;
  std::vector<ResultRow> rows;  ///< of the design sheet
  Warnings warnings;
  bool feasible = true;  ///< by formula and, if simulated, in simulation; also true without requirements
};

/// Computes the design sheet of a setup and, if it has [requirements], the recommended setup or the reasons why none
/// exists. Writes the figures and the recommended setup.
/// @throws SetupError with all problems of the setup and the question
/// @throws DataError if the design has no light cone, or for --apply without [requirements]
/// @throws OutputError if a file cannot be written
DesignReport design(DesignRequest const& request);
/// Like design() above, for a setup in memory; request.setup is its name in messages and request.overrides are ignored.
DesignReport design(SetupDocument document, DesignRequest const& request);

}  // namespace gladstone
