#pragma once

namespace gladstone::inline files {

/// Environment variable that selects a stop point: "NAME", or "NAME:3" for the third time that it is reached.
inline constexpr char const* stop_variable = "GLADSTONE_STOP_AT";

/// Stops the process (SIGSTOP, until SIGCONT) if GLADSTONE_STOP_AT contains this name. Tests use it to interfere with a
/// command at a defined point. CONTRIBUTING.md lists the points.
void stop_point(char const* name);

}  // namespace gladstone::inline files
