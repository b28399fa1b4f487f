#pragma once

namespace gladstone {

/// Environment variable of stop_point(): "NAME", or "NAME:3" for the third time that the point is reached.
inline constexpr char const* stop_variable = "GLADSTONE_STOP_AT";

/// A named point of a command, at which a test stops the program to disturb it there: where GLADSTONE_STOP_AT holds
/// this name, the process stops itself (SIGSTOP) until it is sent SIGCONT. CONTRIBUTING.md lists the points.
void stop_point(char const* name);

}  // namespace gladstone
