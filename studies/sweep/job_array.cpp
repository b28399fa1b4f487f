#include "studies/sweep/job_array.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <string_view>

#include "render/base/contracts.h"
#include "render/base/error.h"
#include "studies/sweep/case_list.h"

namespace gladstone::inline sweep {
namespace {

constexpr char const* script_text = R"(#!/bin/sh
# Written by "gladstone sweep run --slurm": {cases} missing cases in {tasks} tasks, one line of cases a task.
# Complete results are not computed again: a task that was preempted or requeued continues with the missing cases.
cases=$(sed -n "$((SLURM_ARRAY_TASK_ID + 1))p" <<'END'
{lines}
END
)
exec {program} sweep run {run} --case "$cases" --threads "${{SLURM_CPUS_ON_NODE:-1}}"{options}
)";

std::string replaced(std::string text, std::string_view old, std::string_view replacement) {
  for (std::size_t at = 0; (at = text.find(old, at)) != std::string::npos; at += replacement.size())
    text.replace(at, old.size(), replacement);
  return text;
}

std::vector<std::string> slices(std::vector<std::size_t> const& cases, std::size_t size) {
  std::vector<std::string> tasks;
  for (std::size_t first = 0; first < cases.size(); first += size) {
    auto const begin = cases.begin() + static_cast<std::ptrdiff_t>(first);
    auto const end = cases.begin() + static_cast<std::ptrdiff_t>(std::min(first + size, cases.size()));
    tasks.push_back(case_list({begin, end}));
  }
  return tasks;
}

}  // namespace

std::string job_script_path(std::string const& run) {
  return (std::filesystem::path(run) / "slurm" / "job.sh").string();
}

std::string shell_word(std::string const& text) {
  constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_-+=./:,%@";
  if (!text.empty() && text.find_first_not_of(plain) == std::string::npos) return text;
  return '\'' + replaced(text, "'", "'\\''") + '\'';
}

JobArray make_job_array(std::string const& program, std::string const& run, std::vector<std::size_t> const& cases,
                        SlurmOptions const& options, std::size_t most) {
  GLADSTONE_EXPECTS(!cases.empty() && most > 0);
  std::size_t const least = (cases.size() + most - 1) / most;
  std::size_t const size = options.cases_per_task == 0 ? least : options.cases_per_task;
  if (size < least) {
    throw DataError(
        ErrorCode::arguments, "--cases-per-task",
        fmt::format("{} cases with {} per task require more tasks than an array of this cluster may have ({}, its "
                    "MaxArraySize); use {} or more",
                    cases.size(), size, most, least));
  }
  JobArray array;
  array.cases = cases.size();
  array.cases_per_task = size;
  array.tasks = slices(cases, size);
  array.script_path = job_script_path(run);
  std::string run_options;
  for (std::string const& option : options.run) run_options += ' ' + shell_word(option);
  array.script = fmt::format(script_text, fmt::arg("cases", cases.size()), fmt::arg("tasks", array.tasks.size()),
                             fmt::arg("lines", fmt::join(array.tasks, "\n")), fmt::arg("program", shell_word(program)),
                             fmt::arg("run", shell_word(run)), fmt::arg("options", run_options));

  // --chdir uses the path literally, whereas --output would interpret a '%' in it.
  std::string const throttle = options.throttle > 0 ? fmt::format("%{}", options.throttle) : "";
  array.command = {"sbatch",
                   "--parsable",
                   "--wait",
                   "--requeue",
                   "--open-mode=append",
                   fmt::format("--array=0-{}{}", array.tasks.size() - 1, throttle),
                   "--job-name=gladstone-" + std::filesystem::path(run).filename().string(),
                   "--chdir=" + run,
                   "--output=slurm/%A_%a.log"};
  if (!options.partition.empty()) array.command.push_back("--partition=" + options.partition);
  if (!options.time.empty()) array.command.push_back("--time=" + options.time);
  if (!options.gres.empty()) array.command.push_back("--gres=" + options.gres);
  array.command.insert(array.command.end(), options.sbatch.begin(), options.sbatch.end());
  array.command.push_back(array.script_path);
  return array;
}

}  // namespace gladstone::inline sweep
