#pragma once

#include <functional>
#include <string>
#include <vector>

namespace gladstone {

/// How a worker process ended.
struct WorkerEnd {
  int exit_code = 0;  ///< -1: a signal ended it
  int signal = 0;
};

/// Runs this executable several times side by side, each with its own arguments, and waits for all.
/// Every worker is told `--worker FD`, where it is to write a line for each finished case. Ctrl-C stops them all;
/// should this process be killed, they are killed with it.
/// @param environment added to each worker's own, "NAME=value"; empty strings add nothing
/// @param finished    called for every line
/// @throws OutputError where a process cannot be started, Interrupted once all have stopped
std::vector<WorkerEnd> run_workers(std::vector<std::vector<std::string>> const& arguments,
                                   std::vector<std::string> const& environment, std::function<void()> const& finished);

}  // namespace gladstone
