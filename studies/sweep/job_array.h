#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace gladstone::inline sweep {

/// Options of a Slurm job array that computes the missing cases of a study. Texts are passed to sbatch unchanged.
struct SlurmOptions {
  std::string partition;            ///< sbatch --partition; empty: default of the cluster
  std::string time;                 ///< sbatch --time per task; empty: default of the partition
  std::string gres;                 ///< sbatch --gres per task, such as "gpu:1"
  std::vector<std::string> sbatch;  ///< other options of sbatch, such as "--account=flow"
  std::vector<std::string> run;     ///< other options of each task's `sweep run`, such as "--keep-images"
  std::size_t cases_per_task = 0;   ///< number of cases per task; 0: the minimum that the cluster's array size permits
  std::size_t throttle = 0;         ///< maximum number of concurrent tasks; 0: no limit
};

/// Job array that is ready for submission; each task computes a slice of the cases.
struct JobArray {
  std::size_t cases = 0;
  std::size_t cases_per_task = 0;    ///< number of cases per task; the last task may have fewer
  std::vector<std::string> tasks;    ///< cases of each task, in the format of case_list()
  std::string script;                ///< text of the job script
  std::string script_path;           ///< RUN/slurm/job.sh; each task writes its log JOB_TASK.log to the same folder
  std::vector<std::string> command;  ///< command line that submits the array: sbatch and its arguments
};

/// Returns RUN/slurm/job.sh.
std::string job_script_path(std::string const& run);

/// Quotes a text, if necessary, so that a shell reads it as one word.
std::string shell_word(std::string const& text);

/// Divides the cases into tasks and generates the job script. A task runs `PROGRAM sweep run RUN --case SLICE`, which
/// computes only missing cases, so that tasks can be repeated safely.
/// @param program  absolute path of gladstone on the nodes
/// @param run      absolute path of the study's RUN folder on the nodes
/// @param cases    missing cases, in ascending order
/// @param most     maximum number of tasks of an array on this cluster
/// @throws DataError with the required number of cases per task if more tasks would be needed
JobArray make_job_array(std::string const& program, std::string const& run, std::vector<std::size_t> const& cases,
                        SlurmOptions const& options, std::size_t most);

}  // namespace gladstone::inline sweep
