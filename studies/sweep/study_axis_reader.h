#pragma once

#include <functional>
#include <memory>
#include <string>

#include "studies/sweep/study_file.h"

namespace gladstone::inline sweep {

/// Receives a problem of a study file and its position in the file.
using ReportProblem = std::function<void(SetupPlace const& place, std::string message)>;

/// Reads an axis of a study file: a list of values, or a range.
/// @param key     key path in the setup
/// @param source  the study file, for values that are inserted into another document
/// @param mode    values of a list may repeat in a zip only
AxisPlan read_study_axis(std::string const& key, SetupNode const& node,
                         std::shared_ptr<SetupSource const> const& source, StudyMode mode,
                         ReportProblem const& problem);

}  // namespace gladstone::inline sweep
