#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace gladstone {

/// How a worker process ended.
struct WorkerEnd {
  int exit_code = 0;  ///< -1: a signal ended it
  int signal = 0;
  std::optional<std::size_t> at;  ///< the case that it was at work on
};

/// What a worker writes to its parent: which case it has begun or finished.
struct WorkerReport {
  std::uint64_t index = 0;
  std::uint64_t finished = 0;  ///< 0 or 1
};

/// Runs this executable several times side by side, each with its own arguments, and waits for all.
/// Every worker is told `--worker FD`, where it is to write a WorkerReport before and after each case. Ctrl-C stops
/// them all; should this process be killed, they are killed with it.
/// @param environment added to each worker's own, "NAME=value"; empty strings add nothing
/// @param finished    called for every finished case
/// @param restart     asked about each worker that a signal has ended: true starts another one in its place
/// @return how those ended that were not replaced
/// @throws OutputError where a process cannot be started, Interrupted once all have stopped
std::vector<WorkerEnd> run_workers(std::vector<std::vector<std::string>> const& arguments,
                                   std::vector<std::string> const& environment, std::function<void()> const& finished,
                                   std::function<bool(WorkerEnd const&)> const& restart);

}  // namespace gladstone
