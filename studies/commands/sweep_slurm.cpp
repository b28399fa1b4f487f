#include "studies/commands/sweep_slurm.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "studies/case/json_text.h"
#include "studies/commands/arguments.h"

namespace gladstone::inline commands {
namespace {

namespace fs = std::filesystem;

/// Removes the cases that need no further computation.
void remove_done(std::string const& run, Manifest const& cases, RunSelection const& selection,
                 std::vector<std::size_t>& remaining) {
  // List the folder once instead of looking up every result file.
  std::set<std::string> there;
  std::error_code ignored;
  for (auto const& entry : fs::directory_iterator(fs::path(run) / run_file::cases, ignored))
    there.insert(entry.path().filename().string());
  std::erase_if(remaining, [&](std::size_t index) {
    if (!there.contains(fs::path(result_path(run, index)).filename().string())) return false;
    auto const result = read_result(run, index, cases.line_hash(index), ResultPart::head);
    return result && !needs_recomputation(*result, selection) && !is_missing_parts(run, *result, selection);
  });
}

void print_dry_run(JobArray const& array, GlobalOptions const& options) {
  std::string command;
  for (std::string const& word : array.command) command += (command.empty() ? "" : " ") + shell_word(word);
  nlohmann::ordered_json const json{{"cases", array.cases},
                                    {"tasks", array.tasks.size()},
                                    {"script", array.script},
                                    {"script_file", array.script_path},
                                    {"command", array.command}};
  print_result(options, json_text(json), fmt::format("# {}\n{}\n{}\n", array.script_path, array.script, command));
}

/// Returns the last log messages of the tasks with unfinished cases, at most five of them.
std::string words_of_failed_tasks(JobArray const& array, std::string const& job, std::vector<std::size_t> const& due,
                                  std::vector<std::size_t> const& remaining) {
  constexpr std::size_t most_told = 5;
  std::set<std::size_t> tasks;
  for (std::size_t const index : remaining) {
    auto const place = std::lower_bound(due.begin(), due.end(), index) - due.begin();
    tasks.insert(static_cast<std::size_t>(place) / array.cases_per_task);
  }
  std::string text;
  for (std::size_t told = 0; std::size_t const task : tasks) {
    if (told++ == most_told) {
      text += fmt::format("  ... and {} more tasks\n", tasks.size() - most_told);
      break;
    }
    std::string const words = last_log_message(array, job, task);
    text += fmt::format("  task {}_{} (cases {}) did not finish its cases; {}\n", job, task, array.tasks[task],
                        words.empty() ? "no message" : "last message: " + words);
  }
  return text;
}

}  // namespace

void add_slurm_options(CLI::App& app, SlurmArguments& arguments) {
  SlurmOptions& options = arguments.options;
  auto* const slurm =
      app.add_flag("--slurm", arguments.submit, "Submit the missing cases to a Slurm cluster as a job array, and wait");
  auto const only_with_slurm = [slurm](CLI::Option* option) { option->needs(slurm)->group("With --slurm"); };
  only_with_slurm(app.add_option("--partition", options.partition, "Partition of the cluster"));
  only_with_slurm(app.add_option("--time", options.time, "Time limit of a task: 30 (minutes), 2:00:00, 1-12"));
  only_with_slurm(app.add_option("--gres", options.gres, "Resources of a task: gpu:1"));
  only_with_slurm(app.add_option("--cases-per-task", options.cases_per_task,
                                 "Cases per task; default: the smallest number that the cluster accepts")
                      ->check(whole_number(1, 1000000)));
  only_with_slurm(
      app.add_option("--throttle", options.throttle, "Maximum number of simultaneous tasks; default: no limit")
          ->check(whole_number(1, 1000000)));
  only_with_slurm(app.add_option("--sbatch", options.sbatch, "Additional option for sbatch: --sbatch=--account=flow")
                      ->take_all()
                      ->expected(1)
                      ->trigger_on_parse(false));
  only_with_slurm(app.add_flag("--dry-run", arguments.dry_run, "Print the job script and the command; submit nothing"));
}

std::optional<JobReport> run_on_cluster(std::string const& run, Manifest const& cases,
                                        std::vector<std::size_t> const& selected, RunSelection const& selection,
                                        SlurmArguments const& arguments, GlobalOptions const& options) {
  std::vector<std::size_t> due = selected;
  remove_done(run, cases, selection, due);
  if (due.empty()) return std::nullopt;
  std::vector<std::size_t> remaining = due;
  auto const count_remaining = [&] {
    remove_done(run, cases, selection, remaining);
    return remaining.size();
  };

  std::string const folder = fs::canonical(run).string();
  if (auto const job = find_running_job(folder); job && !arguments.dry_run) {
    wait_for_job(*job, count_remaining);
    return JobReport{*job, ""};
  }
  JobArray const array =
      make_job_array(fs::read_symlink("/proc/self/exe").string(), folder, due, arguments.options, most_array_tasks());
  if (arguments.dry_run) {
    print_dry_run(array, options);
    return JobReport{};
  }
  JobEnd const end = run_job_array(array, count_remaining);
  return JobReport{end.job, words_of_failed_tasks(array, end.job, due, remaining)};
}

}  // namespace gladstone::inline commands
