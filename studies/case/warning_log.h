#pragma once

#include "render/base/warning.h"

namespace gladstone::inline cases {

/// Writes a warning to the log.
void log_warning(Warning const& warning);
void log_warnings(Warnings const& warnings);

/// Returns the warning that this thread is writing to the log, for sinks that need its code and place; null if
/// another function writes the message.
Warning const* warning_being_logged();

}  // namespace gladstone::inline cases
