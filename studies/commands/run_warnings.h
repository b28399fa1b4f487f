#pragma once

#include "render/base/warning.h"

namespace spdlog {
class logger;
}

namespace gladstone::inline commands {

/// Adds a sink to a logger that records all warnings, for the member `warnings` of --json.
void record_warnings(spdlog::logger& log);

/// Returns the distinct warnings recorded so far, in their order.
Warnings recorded_warnings();

}  // namespace gladstone::inline commands
