#pragma once

#include <optional>
#include <string>
#include <vector>

#include "studies/commands/command.h"
#include "studies/sweep/manifest.h"
#include "studies/sweep/run.h"
#include "studies/sweep/slurm.h"

namespace gladstone {

/// What `sweep run` is told about a cluster.
struct SlurmArguments {
  bool submit = false;   ///< --slurm
  bool dry_run = false;  ///< print what would be submitted
  SlurmOptions options;
};

/// Adds --slurm and what goes with it to `sweep run`.
void add_slurm_options(CLI::App& app, SlurmArguments& arguments);

/// A job that has been waited for: its number and, in text, what is known of the tasks that left cases undone.
struct JobReport {
  std::string job;  ///< empty: it was a --dry-run
  std::string text;
};

/// Submits the cases that a selection lacks to Slurm, or finds the study's job at work already, and waits for its end.
/// With --dry-run prints the script and the command that submits it instead.
/// @return nothing where no case is due
/// @throws as run_job_array and make_job_array
std::optional<JobReport> run_on_cluster(std::string const& run, Manifest const& cases,
                                        std::vector<std::size_t> const& selected, RunSelection const& selection,
                                        SlurmArguments const& arguments, GlobalOptions const& options);

}  // namespace gladstone
