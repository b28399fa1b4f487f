#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <map>
#include <nlohmann/json.hpp>
#include <sstream>

#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/base/text.h"
#include "render/files/stop_point.h"
#include "studies/case/json_text.h"
#include "studies/case/warning_log.h"
#include "studies/commands/arguments.h"
#include "studies/commands/sweep_slurm.h"
#include "studies/sweep/run.h"
#include "studies/sweep/state_report.h"
#include "studies/sweep/workers.h"

namespace gladstone::inline commands {
namespace {

struct Arguments {
  std::string run, shard;
  RunSelection selection;
  int jobs = 0;         ///< number of worker processes; 0: one, or one per GPU; with --devices two per GPU
  std::string devices;  ///< "all" or the number of GPUs to use; empty: all, one process each
  int worker = -1;      ///< file descriptor to which a worker reports finished cases; -1: not a worker
  double first = 0;     ///< fraction of the selection at which a worker starts
  SlurmArguments slurm;
};

/// Parses --shard I/N. @throws DataError
void read_shard(Arguments& arguments) {
  if (arguments.shard.empty()) return;
  std::istringstream text(arguments.shard);
  char slash = 0;
  long long shard = -1, shards = 0;
  if (!(text >> shard >> slash >> shards) || slash != '/' || !text.eof() || shards < 1 || shard < 0 ||
      shard >= shards) {
    throw DataError(
        ErrorCode::arguments, "--shard",
        fmt::format("{} is not I/N with I from 0 to N - 1; write 0/3 for the first of three", arguments.shard));
  }
  arguments.selection.shard = static_cast<std::size_t>(shard);
  arguments.selection.shards = static_cast<std::size_t>(shards);
}

/// Returns the device of the manifest. @throws DeviceError if the command line specifies another
std::string planned_device(Manifest const& cases, std::string const& wanted) {
  std::string const planned = cases[0].device;
  if (wanted != "auto" && wanted != planned) {
    throw DeviceError(
        fmt::format("--device {}: the study was planned for {} (results are equal bit by bit on one kind of device "
                    "only); omit --device, or plan the study again",
                    wanted, planned));
  }
  return planned;
}

/// Number of processes per GPU with the shortest time of a study: one computes on the host while the other one uses the
/// GPU (docs/performance.md).
constexpr int workers_per_gpu = 2;

/// Returns the GPUs of this host as in CUDA_VISIBLE_DEVICES, at most the number given by --devices; empty for the CPU.
/// @throws DeviceError if --devices asks for more GPUs than there are, or the study was planned for the CPU
std::vector<std::string> select_gpus(std::string const& devices, std::string const& device) {
  if (device != "cuda") {
    if (devices.empty()) return {};
    throw DeviceError(
        fmt::format("--devices {}: the study was planned for {} and uses no GPU; omit --devices, or plan the study "
                    "again with --device cuda",
                    devices, device));
  }
  std::vector<std::string> names;
  auto const usable = static_cast<std::size_t>(std::max(0, gpu_count()));
  if (char const* const given = std::getenv("CUDA_VISIBLE_DEVICES")) {
    std::istringstream list(given);
    for (std::string name; std::getline(list, name, ',');) names.push_back(name);
  } else {
    for (std::size_t gpu = 0; gpu < usable; ++gpu) names.push_back(std::to_string(gpu));
  }
  // CUDA ignores the names after the first one that does not exist.
  names.resize(std::min(names.size(), usable));
  if (devices.empty()) return names;
  std::size_t const wanted = devices == "all" ? std::max<std::size_t>(1, names.size()) : std::stoul(devices);
  if (wanted > names.size()) {
    throw DeviceError(fmt::format(
        "--devices {}: {}; {}", devices,
        names.empty() ? "no GPU can be used on this host"
                      : fmt::format("this host has {} usable GPU{}", names.size(), names.size() > 1 ? "s" : ""),
        names.empty() ? "gladstone --version reports why" : "use --devices all"));
  }
  names.resize(wanted);
  return names;
}

/// Returns the number of processes for `due` cases. @param gpus  GPUs to use
int count_jobs(Arguments const& arguments, std::size_t gpus, std::size_t due) {
  std::size_t jobs = std::max<std::size_t>(1, gpus);
  if (!arguments.devices.empty()) jobs *= workers_per_gpu;
  if (arguments.jobs > 0) jobs = static_cast<std::size_t>(arguments.jobs);
  return static_cast<int>(std::min(jobs, due));
}

/// Runs the cases in worker processes, which use the GPUs in turn. A case whose process was terminated by a signal
/// (crash, insufficient memory) is repeated once and then recorded as failed.
/// @return ok, or the exit code of a worker whose error affects the whole run
int run_in_workers(Arguments const& arguments, Manifest const& cases, std::string const& device,
                   std::vector<std::string> const& gpus, int jobs, std::function<void()> const& finished) {
  std::vector<std::vector<std::string>> words;
  std::vector<std::string> environment;
  for (int k = 0; k < jobs; ++k) {
    std::vector<std::string> one{"sweep",       "run",
                                 arguments.run, "--quiet",
                                 "--device",    device,
                                 "--jobs",      "1",
                                 "--threads",   std::to_string(std::max(1, thread_count() / jobs)),
                                 "--first",     fmt::format("{}", static_cast<double>(k) / jobs)};
    if (arguments.selection.only) one.insert(one.end(), {"--case", *arguments.selection.only});
    if (!arguments.shard.empty()) one.insert(one.end(), {"--shard", arguments.shard});
    if (arguments.selection.keep_images) one.emplace_back("--keep-images");
    if (arguments.selection.pairs_only) one.emplace_back("--pairs-only");
    words.push_back(std::move(one));
    environment.push_back(gpus.empty() ? ""
                                       : "CUDA_VISIBLE_DEVICES=" + gpus[static_cast<std::size_t>(k) % gpus.size()]);
  }
  spdlog::info("{} on {}, {} each", count_text(static_cast<std::size_t>(jobs), "worker"), device,
               count_text(static_cast<std::size_t>(std::max(1, thread_count() / jobs)), "thread"));
  std::map<std::size_t, int> deaths;
  auto const restart = [&](WorkerEnd const& end) {
    std::string const signal = fmt::format("ended by signal {} ({})", end.signal, ::strsignal(end.signal));
    if (!end.at) {
      log_warning(
          {WarningCode::failed, "", fmt::format("a worker was {} between two cases and is not started again", signal)});
      return false;
    }
    bool const twice = ++deaths[*end.at] >= 2;
    log_warning({WarningCode::failed, "",
                 fmt::format("a worker was {} while computing case {}; {}", signal, *end.at,
                             twice ? "the case has failed" : "another worker tries it once more")});
    // The system terminates processes that use too much memory by SIGKILL.
    if (twice &&
        record_failure(arguments.run, cases, *end.at, "its process was " + signal + ", twice", end.signal == SIGKILL)) {
      finished();
    }
    return true;
  };
  int code = ok;
  for (WorkerEnd const& end : run_workers(words, environment, finished, restart)) {
    if (end.exit_code == device_error || (end.exit_code == bad_input && code == ok)) code = end.exit_code;
    if (end.exit_code == interrupted_by_user) throw Interrupted();
  }
  return code;
}

void run_here(Arguments const& arguments, Manifest const& cases, std::vector<std::size_t> const& selected,
              std::string const& device, std::function<void()> const& finished) {
  CaseRunner runner(open_device(device));
  auto const first = static_cast<std::size_t>(arguments.first * static_cast<double>(selected.size()));
  auto const tell = [&](std::size_t index, CaseEvent event) {
    WorkerReport const report{index, event == CaseEvent::finished};
    // Continue even if the parent does not read the reports any more.
    if (arguments.worker >= 0 && ::write(arguments.worker, &report, sizeof report) < 0) spdlog::debug("not heard");
    if (event == CaseEvent::finished) finished();
  };
  run_cases(arguments.run, cases, selected, arguments.selection, computation_by(runner), first, tell);
}

/// Prints the state of the selected cases, with additional JSON members and text. @return ok or incomplete
int print_state(Arguments const& arguments, GlobalOptions const& options, Manifest const& cases,
                std::vector<std::size_t> const& selected, nlohmann::ordered_json const& more_json,
                std::string const& more_text) {
  RunState const state = determine_run_state(arguments.run, cases, selected);
  nlohmann::ordered_json json = state_json(arguments.run, cases, state);
  json.update(more_json);
  print_result(options, json_text(json), state_text(arguments.run, cases, state) + more_text);
  return state.complete() ? ok : incomplete;
}

/// Implements --slurm: computes the cases on a cluster.
int submit_study(Arguments const& arguments, GlobalOptions const& options, Manifest const& cases,
                 std::vector<std::size_t> const& selected, std::string const& device) {
  SlurmArguments slurm = arguments.slurm;
  SlurmOptions& given = slurm.options;
  bool const asks_for_gpu = !given.gres.empty() || std::any_of(given.sbatch.begin(), given.sbatch.end(), [](auto& one) {
    return one.find("gpu") != std::string::npos;
  });
  if (device == "cuda" && !asks_for_gpu)
    log_warning({WarningCode::inconsistent, "",
                 "the study was planned for cuda, but no GPU is requested; use --gres gpu:1, unless every node has one "
                 "anyway"});
  if (arguments.jobs > 0) given.run.insert(given.run.end(), {"--jobs", std::to_string(arguments.jobs)});
  if (!arguments.devices.empty()) given.run.insert(given.run.end(), {"--devices", arguments.devices});
  if (arguments.selection.keep_images) given.run.emplace_back("--keep-images");
  if (arguments.selection.pairs_only) given.run.emplace_back("--pairs-only");
  if (arguments.selection.retry_failed) given.run.emplace_back("--retry-failed");
  auto const job = run_on_cluster(arguments.run, cases, selected, arguments.selection, slurm, options);
  if (job && job->job.empty()) return ok;
  nlohmann::ordered_json const json{{"job", job ? nlohmann::ordered_json(job->job) : nullptr}};
  return print_state(arguments, options, cases, selected, json, job ? job->text : "");
}

int run_study(Arguments const& arguments, GlobalOptions const& options) {
  auto const start = std::chrono::steady_clock::now();
  Manifest const cases = read_manifest(arguments.run);
  std::string const device = planned_device(cases, options.device);
  std::vector<std::size_t> const selected = selected_cases(cases.size(), arguments.selection);
  if (arguments.slurm.submit) return submit_study(arguments, options, cases, selected, device);
  std::vector<std::string> const gpus = select_gpus(arguments.devices, device);
  bool const worker = arguments.worker >= 0;
  std::size_t due = selected.size();
  if (!worker) {  // remove failures once here, so that workers do not repeat them several times
    due = remove_failed_results(arguments.run, cases, selected, arguments.selection).missing.size();
  }
  int code = ok;
  std::size_t computed = 0;
  if (due > 0) {
    Progress progress("cases", due);
    Progress::enable(false);  // no progress bars of individual cases
    auto const finished = [&] {
      ++computed;
      progress.advance();
      stop_point("case-finished");
    };
    int const jobs = count_jobs(arguments, gpus.size(), due);
    // worker processes protect this one from crashes, even if only one case remains
    if (jobs > 1 || arguments.jobs > 1) {
      code = run_in_workers(arguments, cases, device, gpus, jobs, finished);
    } else {
      run_here(arguments, cases, selected, device, finished);
    }
  }
  if (worker) return ok;
  if (code != ok) return code;
  double const seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  return print_state(arguments, options, cases, selected,
                     {{"device", device}, {"computed", computed}, {"seconds", seconds}},
                     fmt::format("{:.1f} s\n", seconds));
}

}  // namespace

CommandBody attach_sweep_run(CLI::App& app, GlobalOptions const& options) {
  auto arguments = std::make_shared<Arguments>();
  app.add_option("run", arguments->run, "RUN folder")->required();
  app.add_option(
         "--jobs", arguments->jobs,
         "Number of parallel processes, which share the cores; default: one, or one per GPU; with --devices two "
         "per GPU")
      ->check(whole_number(1, 4096));
  app.add_option("--devices", arguments->devices,
                 "GPUs of this host to use for a study planned for cuda, \"all\" or their number")
      ->check([](std::string const& text) {
        std::string problem = text == "all" ? "" : whole_number(1, 4096)(text);
        if (!problem.empty()) problem.replace(0, std::strlen("expected"), "expected \"all\" or");
        return problem;
      });
  // Distinguish an empty list, which is an error, from a missing option, which selects all cases.
  app.add_option_function<std::string>(
      "--case", [arguments](std::string const& list) { arguments->selection.only = list; },
      "Only these cases, by index: 17, or 0-3,7");
  app.add_option("--shard", arguments->shard, "I/N: the I-th, from 0, of N equal parts of the study, or of --case");
  app.add_flag("--keep-images", arguments->selection.keep_images,
               "Keep the images and files of each case in RUN/cases/INDEX");
  app.add_flag("--pairs-only", arguments->selection.pairs_only,
               "Compute only the images, and keep them like --keep-images: no correlation and no errors");
  app.add_flag("--retry-failed", arguments->selection.retry_failed, "Compute failed cases again");
  add_slurm_options(app, arguments->slurm);
  app.add_option("--worker", arguments->worker)->group("");
  app.add_option("--first", arguments->first)->group("");
  return [arguments, &options]() -> int {
    try {
      read_shard(*arguments);
      return run_study(*arguments, options);
    } catch (Interrupted const&) {
      if (arguments->slurm.submit) throw;  // its message describes the state of the job
      if (arguments->worker < 0) {
        print_error("gladstone: interrupted; finished cases are kept, and the same command continues from there");
      }
      return interrupted_by_user;
    }
  };
}

}  // namespace gladstone::inline commands
