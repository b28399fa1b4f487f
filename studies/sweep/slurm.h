#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "render/base/error.h"
#include "studies/sweep/job_array.h"

namespace gladstone::inline sweep {

/// Error of a Slurm command, which --slurm requires: not installed, or the job was rejected; contains Slurm's message.
class SlurmError : public Error {
 public:
  explicit SlurmError(std::string const& message) : Error(ErrorCode::arguments, message) {}
};

/// Returns the maximum number of tasks of a job array on this cluster (MaxArraySize of `scontrol show config`), or
/// Slurm's default of 1001 if it cannot be determined.
std::size_t most_array_tasks();

/// Final state of a job array.
struct JobEnd {
  std::string job;  ///< job number
  /// Largest exit code of the tasks; 1 if a task was terminated by a signal; nullopt: unknown.
  std::optional<int> exit_code;
};

/// Returns the job that run_job_array() submitted last for this study if it is still queued or running (squeue).
/// @param run  absolute path of the RUN folder
std::optional<std::string> find_running_job(std::string const& run);

/// Returns the number of cases without an intact result. Called at most about once a second, less often if it is slow.
using CountRemaining = std::function<std::size_t()>;

/// Writes the job script, submits the array with `sbatch --wait` and waits until the last task ends or no case remains.
/// Displays a progress bar.
/// @throws SlurmError if sbatch is not installed or rejects the job; OutputError; Interrupted on Ctrl-C: the job
///         continues, and the message explains how to cancel it and how to wait for it again
JobEnd run_job_array(JobArray const& array, CountRemaining const& remaining);

/// Waits for a job returned by find_running_job(). @throws Interrupted, as run_job_array()
JobEnd wait_for_job(std::string const& job, CountRemaining const& remaining);

/// Returns the last line of a task's log, or the last message of Slurm itself if there is one, for example "slurmstepd:
/// error: *** JOB 12 ON node3 CANCELLED ... DUE TO TIME LIMIT ***". Empty if the log does not exist.
std::string last_log_message(JobArray const& array, std::string const& job, std::size_t task);

}  // namespace gladstone::inline sweep
