#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace gladstone::inline sweep {

/// Final state of a worker process.
struct WorkerEnd {
  int exit_code = 0;  ///< exit code; -1: terminated by a signal
  int signal = 0;
  std::optional<std::size_t> at;  ///< case that the process was computing when it ended
};

/// Message from a worker to its parent: a case was begun or finished.
struct WorkerReport {
  std::uint64_t index = 0;
  std::uint64_t finished = 0;  ///< 1: the case was finished; 0: it was begun
};

/// Runs several instances of this executable in parallel, each with its own arguments, and waits for all of them. Each
/// worker receives the option `--worker FD`, the file descriptor to which it writes a WorkerReport before and after
/// each case. Ctrl-C stops all workers; if this process is killed, they are killed as well.
/// @param environment  "NAME=value" to add to each worker's environment; empty: nothing
/// @param finished     called for every finished case
/// @param restart      called for each worker that was terminated by a signal; true starts a replacement
/// @return final states of the workers that were not replaced
/// @throws OutputError if a process cannot be started; Interrupted after all workers have stopped
std::vector<WorkerEnd> run_workers(std::vector<std::vector<std::string>> const& arguments,
                                   std::vector<std::string> const& environment, std::function<void()> const& finished,
                                   std::function<bool(WorkerEnd const&)> const& restart);

}  // namespace gladstone::inline sweep
