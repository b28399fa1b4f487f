#pragma once

#include <nlohmann/json_fwd.hpp>

#include "studies/case/case.h"
#include "studies/case/write_case.h"

namespace gladstone::inline cases {

/// Returns the contents of summary.json, whose keys are defined in docs/file-formats.md.
nlohmann::json case_summary(CaseSetup& loaded, PreparedCase const& prepared, RenderedCase const& rendered,
                            RecordedFrames const& frames, CaseOutcome const& outcome);

}  // namespace gladstone::inline cases
