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

namespace gladstone {
namespace {

constexpr char const* executable = "/proc/self/exe";

/// The child's side of a start: nothing but calls that are safe after fork.
[[noreturn]] void become_worker(std::vector<char*> const& argv, std::string const& variable, int report, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(126);  // it was gone before
  int const nowhere = ::open("/dev/null", O_WRONLY);
  ::dup2(nowhere, STDOUT_FILENO);  // the result is the parent's to print
  ::fcntl(report, F_SETFD, 0);
  if (!variable.empty()) ::putenv(const_cast<char*>(variable.c_str()));
  ::execv(executable, argv.data());
  ::_exit(126);
}

}  // namespace

std::vector<WorkerEnd> run_workers(std::vector<std::vector<std::string>> const& arguments,
                                   std::vector<std::string> const& environment, std::function<void()> const& finished) {
  int pipe[2];
  if (::pipe2(pipe, O_CLOEXEC) != 0) throw OutputError("workers", std::strerror(errno));
  std::vector<pid_t> workers;
  auto const stop_all = [&workers](int signal) {
    for (pid_t const worker : workers) ::kill(worker, signal);
  };
  pid_t const parent = ::getpid();
  for (std::size_t k = 0; k < arguments.size(); ++k) {
    std::vector<std::string> words = arguments[k];
    words.insert(words.begin(), "gladstone");
    words.insert(words.end(), {"--worker", std::to_string(pipe[1])});
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    pid_t const child = ::fork();
    if (child == 0) become_worker(argv, environment[k], pipe[1], parent);
    if (child < 0) {
      int const error = errno;
      stop_all(SIGTERM);
      for (pid_t const worker : workers) ::waitpid(worker, nullptr, 0);
      ::close(pipe[0]);
      ::close(pipe[1]);
      throw OutputError("workers",
                        fmt::format("a process cannot be started ({}); use fewer --jobs", std::strerror(error)));
    }
    workers.push_back(child);
  }
  ::close(pipe[1]);

  // The pipe ends when the last worker does.
  bool stopped = false;
  for (bool open = true; open;) {
    try {
      throw_if_interrupted();
    } catch (Interrupted const&) {
      if (!stopped) stop_all(SIGTERM);
      stopped = true;
    }
    pollfd wait{pipe[0], POLLIN, 0};
    if (::poll(&wait, 1, 100) <= 0) continue;
    char lines[4096];
    ssize_t const size = ::read(pipe[0], lines, sizeof lines);
    if (size < 0 && errno == EINTR) continue;
    open = size > 0;
    for (auto count = std::count(lines, lines + std::max<ssize_t>(size, 0), '\n'); count > 0; --count) finished();
  }
  ::close(pipe[0]);
  std::vector<WorkerEnd> ends;
  for (pid_t const worker : workers) {
    int status = 0;
    while (::waitpid(worker, &status, 0) < 0 && errno == EINTR) {
    }
    ends.push_back({WIFEXITED(status) ? WEXITSTATUS(status) : -1, WIFSIGNALED(status) ? WTERMSIG(status) : 0});
  }
  if (stopped) throw Interrupted();
  return ends;
}

}  // namespace gladstone
