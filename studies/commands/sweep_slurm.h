#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/commands/command.h"
#include "studies/sweep/manifest.h"
#include "studies/sweep/run.h"
#include "studies/sweep/slurm.h"

namespace gladstone::inline commands {

/// Arguments of `sweep run` for a Slurm cluster.
struct SlurmArguments {
  bool submit = false;   ///< --slurm
  bool dry_run = false;  ///< print the job instead of submitting it
  SlurmOptions options;
};

/// Adds --slurm and its related options to `sweep run`.
void add_slurm_options(CLI::App& app, SlurmArguments& arguments);

/// Finished job: its number and a report about the tasks with unfinished cases.
struct JobReport {
  std::string job;  ///< number of the job; empty: --dry-run
  std::string text;
};

/// Submits the missing cases of a selection to Slurm and waits until the job ends. If a job of the study is already
/// queued or running, waits for that one. With --dry-run, prints the job script and the command instead.
/// @return nullopt if no case needs to be computed
/// @throws as run_job_array() and make_job_array()
std::optional<JobReport> run_on_cluster(std::string const& run, Manifest const& cases,
                                        std::vector<std::size_t> const& selected, RunSelection const& selection,
                                        SlurmArguments const& arguments, GlobalOptions const& options);

}  // namespace gladstone::inline commands
