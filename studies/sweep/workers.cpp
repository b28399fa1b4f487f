#include "studies/sweep/workers.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "render/base/error.h"
#include "render/base/interrupt.h"
#include "render/files/stop_point.h"

namespace gladstone::inline sweep {
namespace {

constexpr char const* executable = "/proc/self/exe";

/// Child's side of fork(): only async-signal-safe calls, then exec.
[[noreturn]] void become_worker(std::vector<char*> const& argv, std::string const& variable, int report, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(126);  // the parent has already ended
  int const nowhere = ::open("/dev/null", O_WRONLY);
  ::dup2(nowhere, STDOUT_FILENO);  // only the parent prints results
  ::fcntl(report, F_SETFD, 0);
  ::unsetenv(stop_variable);  // tests stop only the process that they start
  if (!variable.empty()) ::putenv(const_cast<char*>(variable.c_str()));
  ::execv(executable, argv.data());
  ::_exit(126);
}

struct Worker {
  pid_t process = -1;
  int reports = -1;  ///< descriptor from which reports are read; -1: the worker has ended
  WorkerEnd end;
};

Worker start_worker(std::vector<std::string> words, std::string const& variable) {
  int pipe[2];
  if (::pipe2(pipe, O_CLOEXEC) != 0) throw OutputError("workers", std::strerror(errno));
  words.insert(words.begin(), "gladstone");
  words.insert(words.end(), {"--worker", std::to_string(pipe[1])});
  std::vector<char*> argv;
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);
  pid_t const parent = ::getpid(), child = ::fork();
  if (child == 0) become_worker(argv, variable, pipe[1], parent);
  int const error = errno;
  ::close(pipe[1]);
  if (child > 0) return {child, pipe[0], {}};
  ::close(pipe[0]);
  throw OutputError("workers", fmt::format("a process cannot be started ({}); use fewer --jobs", std::strerror(error)));
}

/// Reads the pending reports of a worker. Reports are written atomically, so that only complete ones are read.
void hear(Worker& worker, std::function<void()> const& finished) {
  WorkerReport reports[256];
  ssize_t const size = ::read(worker.reports, reports, sizeof reports);
  if (size < 0 && errno == EINTR) return;
  for (ssize_t i = 0; i < size / static_cast<ssize_t>(sizeof *reports); ++i) {
    worker.end.at.reset();
    if (reports[i].finished != 0) {
      finished();
    } else {
      worker.end.at = reports[i].index;
    }
  }
  if (size > 0) return;
  ::close(worker.reports);  // the pipe is closed when the worker ends
  worker.reports = -1;
  int status = 0;
  while (::waitpid(worker.process, &status, 0) < 0 && errno == EINTR) {
  }
  worker.end.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
  worker.end.signal = WIFSIGNALED(status) ? WTERMSIG(status) : 0;
}

/// Parallel processes, terminated on destruction.
class Workers {
 public:
  Workers() = default;
  Workers(Workers const&) = delete;
  Workers& operator=(Workers const&) = delete;
  ~Workers() {
    stop();
    for (Worker& worker : all) {
      while (worker.reports >= 0) hear(worker, [] {});
    }
  }
  void stop() const {
    for (Worker const& worker : all) {
      if (worker.reports >= 0) ::kill(worker.process, SIGTERM);
    }
  }
  bool any() const {
    return std::any_of(all.begin(), all.end(), [](Worker const& worker) { return worker.reports >= 0; });
  }

  std::vector<Worker> all;
};

}  // namespace

std::vector<WorkerEnd> run_workers(std::vector<std::vector<std::string>> const& arguments,
                                   std::vector<std::string> const& environment, std::function<void()> const& finished,
                                   std::function<bool(WorkerEnd const&)> const& restart) {
  Workers workers;
  for (std::size_t k = 0; k < arguments.size(); ++k) {
    workers.all.push_back(start_worker(arguments[k], environment[k]));
  }
  bool stopped = false;
  while (workers.any()) {
    try {
      throw_if_interrupted();
    } catch (Interrupted const&) {
      if (!stopped) workers.stop();
      stopped = true;
    }
    std::vector<pollfd> wait;
    for (Worker const& worker : workers.all) wait.push_back({worker.reports, POLLIN, 0});
    if (::poll(wait.data(), wait.size(), 100) <= 0) continue;
    for (std::size_t k = 0; k < wait.size(); ++k) {
      if (wait[k].revents == 0) continue;  // workers that have ended are skipped, too
      Worker& worker = workers.all[k];
      hear(worker, finished);
      if (worker.reports >= 0 || worker.end.signal == 0 || stopped || !restart(worker.end)) continue;
      worker = start_worker(arguments[k], environment[k]);
    }
  }
  if (stopped) throw Interrupted();
  std::vector<WorkerEnd> ends;
  for (Worker const& worker : workers.all) ends.push_back(worker.end);
  return ends;
}

}  // namespace gladstone::inline sweep
