#pragma once

#include <functional>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "studies/design/verification.h"
#include "studies/device.h"

namespace gladstone {

/// What `gladstone design` is asked.
struct DesignRequest {
  std::string setup;
  std::vector<std::string> overrides;
  std::string figures;  ///< folder; empty: none are drawn
  std::string figure_format = "png";
  std::string apply;                    ///< file for the recommended setup; empty: none
  VerificationPlan verification;        ///< of no bench: the formulas are believed
  std::function<Device()> open_device;  ///< that does so
};

/// What it answers.
struct DesignReport {
  nlohmann::ordered_json json;
  std::string text;
  std::vector<std::string> warnings;
  bool feasible = true;  ///< by formula and, where it was simulated, in simulation; or nothing was required
};

/// The sheet of a setup and, where it has [requirements], the recommended setup or why none exists. Writes the figures
/// and the recommended setup.
/// @throws SetupError of the setup and of the question, all problems together; DataError where a design has no cone of
///         light, or an --apply without [requirements]; OutputError
DesignReport design(DesignRequest const& request);

}  // namespace gladstone
