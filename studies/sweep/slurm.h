#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>

#include "render/base/error.h"
#include "studies/sweep/job_array.h"

namespace gladstone {

/// There is no Slurm here, or it does not take the job; its own message is passed on.
class SlurmError : public Error {
 public:
  using Error::Error;
};

/// How many tasks a job array of this cluster may have (`scontrol show config`, MaxArraySize); Slurm's own default,
/// 1001, where the cluster does not tell.
std::size_t most_array_tasks();

/// How a job array ended.
struct JobEnd {
  std::string job;               ///< its number
  std::optional<int> exit_code;  ///< largest of the tasks', 1 where a signal ended one; nothing where not known
};

/// The job that run_job_array() submitted last for this study, if it is still queued or running (squeue).
/// @param run absolute path of the RUN folder
std::optional<std::string> job_going_on(std::string const& run);

/// Counts the cases that have no whole result yet. Called about once a second, more rarely where it takes long.
using CountRemaining = std::function<std::size_t()>;

/// Writes the job script, submits the array with `sbatch --wait` and waits for the last task, or until no case remains.
/// What is done is drawn as a progress bar.
/// @throws SlurmError where sbatch is not here or refuses; OutputError; Interrupted on Ctrl-C: the job then goes on, as
///         after any sbatch, and the message says how to cancel it and how to wait again
JobEnd run_job_array(JobArray const& array, CountRemaining const& remaining);

/// Waits for a job_going_on(). @throws Interrupted, as run_job_array()
JobEnd wait_for_job(std::string const& job, CountRemaining const& remaining);

/// The last line in the log of a task, Slurm's own ("slurmstepd: error: *** JOB 12 ON node3 CANCELLED ... DUE TO TIME
/// LIMIT
/// ***") where there is one; empty where there is none.
std::string last_words(JobArray const& array, std::string const& job, std::size_t task);

}  // namespace gladstone
