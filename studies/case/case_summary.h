#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "studies/case/case.h"

namespace gladstone {

/// Quantities determined while a case is written, for its summary.
struct CaseOutcome {
  TruthAccuracy accuracy;
  std::size_t unseen = 0;               ///< number of dots or particles without truth in one of the frames
  std::optional<RaysPlan> table_error;  ///< error of the deflection table, if the truth was computed with one
  std::string device, reference_sha256, flow_sha256;
  std::vector<std::string> warnings;
};

/// Returns the contents of summary.json, whose keys are defined in docs/file-formats.md.
nlohmann::json case_summary(CaseSetup& loaded, PreparedCase const& prepared, RenderedCase const& rendered,
                            RecordedFrames const& frames, CaseOutcome const& outcome);

}  // namespace gladstone
