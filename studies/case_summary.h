#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "studies/case.h"

namespace gladstone {

/// What is found out of a case while it is written, for its summary.
struct CaseOutcome {
  TruthAccuracy accuracy;
  std::size_t unseen = 0;               ///< sources without truth in a frame
  std::optional<RaysPlan> table_error;  ///< where a table made truth
  std::string device, reference_sha256, flow_sha256;
  std::vector<std::string> warnings;
};

/// What summary.json holds; docs/file-formats.md says what its keys mean.
nlohmann::json case_summary(CaseSetup& loaded, PreparedCase const& prepared, RenderedCase const& rendered,
                            RecordedFrames const& frames, CaseOutcome const& outcome);

}  // namespace gladstone
