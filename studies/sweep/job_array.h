#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace gladstone {

/// How the missing cases of a study go to a Slurm cluster; texts are passed to sbatch as they are.
struct SlurmOptions {
  std::string partition;            ///< --partition; empty: the cluster's default
  std::string time;                 ///< --time of a task; empty: the partition's default
  std::string gres;                 ///< --gres of a task, "gpu:1"
  std::vector<std::string> sbatch;  ///< any other options, "--account=flow"
  std::vector<std::string> run;     ///< further options of a task's `sweep run`, "--keep-images"
  std::size_t cases_per_task = 0;   ///< 0: as few as the cluster's arrays allow
  std::size_t throttle = 0;         ///< tasks that run at a time; 0: as many as the cluster has room for
};

/// A job array, ready to be submitted: each of its tasks computes a slice of the cases.
struct JobArray {
  std::size_t cases = 0;
  std::size_t cases_per_task = 0;    ///< the last task may have fewer
  std::vector<std::string> tasks;    ///< the cases of each task, as case_list() writes them
  std::string script;                ///< text of the job script
  std::string script_path;           ///< RUN/slurm/job.sh; the logs of tasks stand beside it, JOB_TASK.log
  std::vector<std::string> command;  ///< that submits it: sbatch and its arguments
};

/// RUN/slurm/job.sh
std::string job_script_path(std::string const& run);

/// Text as one word of a shell's command line, quoted where it needs to be.
std::string shell_word(std::string const& text);

/// Slices the cases into tasks and writes what runs them. A task calls `PROGRAM sweep run RUN --case SLICE`, which
/// computes only what is missing, so that a task may be repeated at will.
/// @param program absolute path of gladstone, as the nodes see it
/// @param run     absolute path of the study's RUN folder, as the nodes see it
/// @param cases   missing ones, growing
/// @param most    tasks in an array of this cluster
/// @throws std::invalid_argument where more tasks are needed, with how many cases a task must have
JobArray make_job_array(std::string const& program, std::string const& run, std::vector<std::size_t> const& cases,
                        SlurmOptions const& options, std::size_t most);

}  // namespace gladstone
