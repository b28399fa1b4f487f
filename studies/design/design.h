#pragma once

#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/setup/setup_table.h"
#include "studies/case/backend.h"
#include "studies/design/answer_text.h"
#include "studies/design/measurement_inputs.h"
#include "studies/design/sheet.h"
#include "studies/design/verification.h"

namespace gladstone::inline design {

/// Arguments of `gladstone design`.
struct DesignRequest {
  std::string setup;
  std::vector<std::string> overrides;
  std::string apply;                     ///< file for the recommended setup; empty: not written
  VerificationPlan verification;         ///< number of designs and repeats to simulate; benches = 0: no simulation
  std::function<Backend()> open_device;  ///< opens the device of the simulation
};

/// Result of `gladstone design`.
struct DesignReport {
  DesignSheet sheet;                                  ///< sheet of the setup as written
  std::optional<MeasurementUncertainty> uncertainty;  ///< empty if no input has an uncertainty
  std::optional<AnsweredQuestion> answer;             ///< empty without [requirements]
  std::optional<DesignSheet> recommended_sheet;       ///< empty if no design is feasible by formula
  Setup setup;                                        ///< as written
  std::unique_ptr<FixedDesignParameters> given;       ///< parameters of a BOS setup as written
  /// BOS: the recommended set-up, or that of the setup as written if none is recommended
  std::optional<DesignPoint<double>> best;
  std::string text;
  Warnings warnings;
  bool feasible = true;  ///< by formula and, if simulated, in simulation; also true without requirements
};

/// Computes the design sheet of a setup and, if it has [requirements], the recommended setup or the reasons why none
/// exists. Writes the recommended setup.
/// @throws SetupError with all problems of the setup and of the requested design
/// @throws DataError if the design has no light cone, or for --apply without [requirements]
/// @throws OutputError if a file cannot be written
DesignReport answer_design(DesignRequest const& request);
/// Like answer_design() above, for a setup in memory; request.setup is its name in messages and request.overrides are
/// ignored.
DesignReport answer_design(SetupDocument document, DesignRequest const& request);

/// Returns the design sheets, the uncertainty and the answer as JSON.
nlohmann::ordered_json design_json(DesignReport const& report);

}  // namespace gladstone::inline design
