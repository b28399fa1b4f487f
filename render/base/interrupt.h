#pragma once

namespace gladstone::inline base {

/// Installs handlers for SIGINT (Ctrl-C), SIGTERM and SIGHUP (closed terminal; ignored under nohup) that set a flag for
/// throw_if_interrupted(). A second Ctrl-C ends the process immediately; the next run removes its temporary files. Also
/// ignores SIGXFSZ, so that exceeding the limit on file sizes is a write error. Called once, by main().
void catch_interrupts();

/// Requests that all running computations stop, as Ctrl-C does. For programs with their own signal handling, such as
/// Python.
void request_interrupt();
/// Withdraws the request to stop, so that the next computation runs.
void clear_interrupt();

/// Throws Interrupted if the user has asked to stop. The cost is one atomic load.
void throw_if_interrupted();

}  // namespace gladstone::inline base
