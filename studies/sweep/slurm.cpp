#include "studies/sweep/slurm.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <spawn.h>
#include <spdlog/spdlog.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <sstream>
#include <thread>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/base/progress.h"
#include "render/files/input_guard.h"
#include "render/files/output_file.h"

extern char** environ;

namespace gladstone::inline sweep {
namespace {

using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

/// Running Slurm command whose output is captured. It has its own process group and is not affected by Ctrl-C.
class Started {
 public:
  /// @throws SlurmError if the program does not exist
  explicit Started(std::vector<std::string> command)
      : out_(std::tmpfile(), std::fclose), err_(std::tmpfile(), std::fclose) {
    if (!out_ || !err_)
      throw OutputError("/tmp", fmt::format("cannot create a temporary file ({})", std::strerror(errno)));
    std::vector<char*> argv;
    for (std::string& word : command) argv.push_back(word.data());
    argv.push_back(nullptr);
    posix_spawn_file_actions_t actions;
    posix_spawn_file_actions_init(&actions);
    posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, "/dev/null", O_RDONLY, 0);
    posix_spawn_file_actions_adddup2(&actions, fileno(out_.get()), STDOUT_FILENO);
    posix_spawn_file_actions_adddup2(&actions, fileno(err_.get()), STDERR_FILENO);
    posix_spawnattr_t attributes;
    posix_spawnattr_init(&attributes);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    int const error = ::posix_spawnp(&child_, argv[0], &actions, &attributes, argv.data(), environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    if (error != 0) {
      child_ = 0;
      throw SlurmError(
          fmt::format("{} cannot be started ({}): --slurm needs a machine that submits jobs to a Slurm "
                      "cluster; without --slurm the study runs on this one",
                      command[0], std::strerror(error)));
    }
  }
  ~Started() {
    if (child_ <= 0) return;
    ::kill(child_, SIGKILL);
    ::waitpid(child_, nullptr, 0);
  }
  Started(Started const&) = delete;
  Started& operator=(Started const&) = delete;

  /// Returns the exit code if the command has ended, or 128 + N after signal N.
  std::optional<int> exit_code() {
    int status = 0;
    if (child_ > 0 && ::waitpid(child_, &status, WNOHANG) == child_) {
      child_ = 0;
      exit_code_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    }
    return exit_code_;
  }
  std::string out() const { return content(out_.get()); }
  std::string err() const { return content(err_.get()); }

 private:
  using File = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;

  static std::string content(std::FILE* file) {
    std::string text;
    char part[4096];
    for (ssize_t n; (n = ::pread(fileno(file), part, sizeof part, static_cast<off_t>(text.size()))) > 0;)
      text.append(part, static_cast<std::size_t>(n));
    while (text.ends_with('\n')) text.pop_back();
    return text;
  }

  File out_, err_;
  pid_t child_ = 0;
  std::optional<int> exit_code_;
};

/// Waits for the job number that sbatch prints after submission: "123" or "123;cluster".
/// @throws SlurmError with sbatch's message if the job is rejected; Interrupted
std::string submitted_job(Started& sbatch) {
  for (;; std::this_thread::sleep_for(milliseconds(20))) {
    std::optional<int> const ended = sbatch.exit_code();
    std::string const out = sbatch.out();
    if (!out.empty()) return out.substr(0, out.find_first_of(";\n"));
    if (ended) {
      std::string const message = sbatch.err();
      throw SlurmError("the job was not submitted: " +
                       (message.empty() ? fmt::format("sbatch ended with exit code {}", *ended) : message));
    }
    throw_if_interrupted();
  }
}

/// Waits for a short command. @throws Interrupted
void finish(Started& command) {
  while (!command.exit_code()) {
    throw_if_interrupted();
    std::this_thread::sleep_for(milliseconds(10));
  }
}

/// Returns true if a job is queued or running, or if the cluster does not respond.
bool goes_on(std::string const& job) {
  Started squeue({"squeue", "--noheader", "--jobs=" + job});
  finish(squeue);
  return squeue.exit_code() == 0 ? !squeue.out().empty() : squeue.err().find("Invalid job id") == std::string::npos;
}

/// Waits until a job has ended or no case remains.
/// @param ended  returns the job's final state once it has ended; called frequently
JobEnd watch(std::string const& job, CountRemaining const& remaining,
             std::function<std::optional<JobEnd>()> const& ended) try {
  std::size_t left = remaining();
  Progress progress("job " + job, left);
  auto const count = [&] {
    std::size_t const now = std::min(remaining(), left);
    progress.advance(left - now);
    left = now;
  };
  // Counting reads files, perhaps over a network; limit it to a twentieth of the time.
  Clock::time_point due = Clock::now();
  std::optional<JobEnd> end;
  for (; left > 0 && !(end = ended()); std::this_thread::sleep_for(milliseconds(50))) {
    throw_if_interrupted();
    if (Clock::now() < due) continue;
    Clock::time_point const start = Clock::now();
    count();
    due = Clock::now() + std::max<Clock::duration>(milliseconds(500), 20 * (Clock::now() - start));
  }
  if (!end) return {job, 0};
  // After a successful job, a network file system may show the result files with a delay.
  Clock::time_point const patience = Clock::now() + std::chrono::seconds(end->exit_code == 0 ? 90 : 0);
  for (count(); left > 0 && Clock::now() < patience; count()) {
    throw_if_interrupted();
    std::this_thread::sleep_for(milliseconds(500));
  }
  return *end;
} catch (Interrupted const&) {
  throw Interrupted(fmt::format(
      "interrupted; job {0} continues. To wait for it, repeat the command; to cancel it: scancel {0}", job));
}

std::string job_file(std::string const& script_path) {
  return (std::filesystem::path(script_path).parent_path() / "job").string();
}

}  // namespace

std::size_t most_array_tasks() {
  constexpr std::size_t slurms_default = 1001;
  std::string configuration;
  try {
    Started scontrol({"scontrol", "show", "config"});
    finish(scontrol);
    configuration = scontrol.out();
  } catch (SlurmError const&) {
    return slurms_default;
  }
  std::istringstream lines(configuration);
  for (std::string line, name, equals; std::getline(lines, line);) {
    std::istringstream words(line);
    std::size_t most = 0;
    if (words >> name >> equals >> most && name == "MaxArraySize" && most > 0) return most;
  }
  return slurms_default;
}

std::optional<std::string> find_running_job(std::string const& run) {
  std::string job;
  std::ifstream(job_file(job_script_path(run))) >> job;
  if (job.empty() || job.find_first_not_of("0123456789") != std::string::npos) return std::nullopt;
  try {
    if (goes_on(job)) return job;
  } catch (SlurmError const&) {  // squeue is not available
  }
  return std::nullopt;
}

JobEnd run_job_array(JobArray const& array, CountRemaining const& remaining) {
  ProtectedWritePermit const own;
  OutputFile::write_text(array.script_path, array.script);
  Started sbatch(array.command);
  std::string const job = submitted_job(sbatch);
  OutputFile::write_text(job_file(array.script_path), job + '\n');
  spdlog::info("job {}: missing cases: {}, tasks: {}, their logs: {}/{}_*.log", job, array.cases, array.tasks.size(),
               std::filesystem::path(array.script_path).parent_path().string(), job);
  return watch(job, remaining, [&]() -> std::optional<JobEnd> {
    auto const exit_code = sbatch.exit_code();
    return exit_code ? std::optional(JobEnd{job, exit_code}) : std::nullopt;
  });
}

JobEnd wait_for_job(std::string const& job, CountRemaining const& remaining) {
  spdlog::info("job {} of this study is still active: waiting for it", job);
  Clock::time_point due = Clock::now();
  return watch(job, remaining, [&]() -> std::optional<JobEnd> {
    if (Clock::now() < due) return std::nullopt;
    due = Clock::now() + std::chrono::seconds(10);
    return goes_on(job) ? std::nullopt : std::optional(JobEnd{job, std::nullopt});
  });
}

std::string last_log_message(JobArray const& array, std::string const& job, std::size_t task) {
  std::ifstream log(std::filesystem::path(array.script_path).replace_filename(fmt::format("{}_{}.log", job, task)));
  std::string last, slurms_own;
  for (std::string line; std::getline(log, line);) {
    if (line.starts_with("slurmstepd")) slurms_own = line;
    if (!line.empty()) last = line;
  }
  return slurms_own.empty() ? last : slurms_own;
}

}  // namespace gladstone::inline sweep
