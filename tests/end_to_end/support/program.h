#pragma once

#include <fcntl.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "render/files/stop_point.h"
#include "tests/support/folder_fixture.h"

namespace gladstone::end_to_end {

/// Outcome of a run of the program.
struct Outcome {
  int exit_code = -1;  ///< exit code; -1: a signal killed the program
  int signal = 0;      ///< signal that killed the program; 0: none
  std::string out;     ///< text on stdout
  std::string err;     ///< text on stderr
};

/// A run of the program, started as by a shell.
class Program {
 public:
  /// @param folder  working directory
  /// @param prepare  run in the child before the program replaces it; false: give up with exit code 126
  Program(std::vector<std::string> arguments, std::filesystem::path const& folder,
          std::function<bool()> const& prepare = {}) {
    char name[] = "/tmp/gladstone_streams_XXXXXX";
    streams_ = ::mkdtemp(name);
    arguments.insert(arguments.begin(), GLADSTONE_PROGRAM);
    std::vector<char*> argv;
    for (auto& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    std::string const out = (streams_ / "out").string(), err = (streams_ / "err").string();
    child_ = ::fork();
    if (child_ != 0) return;
    int const out_file = ::open(out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    int const err_file = ::open(err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0666);
    ::dup2(out_file, STDOUT_FILENO);
    ::dup2(err_file, STDERR_FILENO);
    if (::chdir(folder.c_str()) != 0 || (prepare && !prepare())) ::_exit(126);
    ::execv(argv[0], argv.data());
    ::_exit(126);
  }
  ~Program() {
    if (child_ > 0) finish(std::chrono::seconds(0));
    std::error_code ignored;
    std::filesystem::remove_all(streams_, ignored);
  }
  Program(Program const&) = delete;
  Program& operator=(Program const&) = delete;

  void send(int signal) const { ::kill(child_, signal); }

  /// Waits, without a time limit, until the program has stopped itself at the point given to stopping_at().
  /// @return false if the program has ended without reaching the point
  bool wait_until_stopped() {
    int status = 0;
    while (::waitpid(child_, &status, WUNTRACED) < 0 && errno == EINTR) {
    }
    if (WIFSTOPPED(status)) return true;
    ended_ = status;
    return false;
  }

  /// Returns true if the program has ended.
  bool has_ended() {
    int status = 0;
    if (!ended_ && ::waitpid(child_, &status, WNOHANG) == child_) ended_ = status;
    return ended_.has_value();
  }

  /// Returns the output on stderr so far.
  std::string err() const { return content(streams_ / "err"); }

  /// Waits until the program ends; kills it if it exceeds the time limit.
  Outcome finish(std::chrono::milliseconds limit) {
    auto const end = std::chrono::steady_clock::now() + limit;
    while (!has_ended()) {
      if (std::chrono::steady_clock::now() >= end) {
        int status = 0;
        ::kill(child_, SIGKILL);
        ::waitpid(child_, &status, 0);
        ended_ = status;
      } else {
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
      }
    }
    int const status = *ended_;
    child_ = 0;
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, WIFSIGNALED(status) ? WTERMSIG(status) : 0,
            content(streams_ / "out"), content(streams_ / "err")};
  }

 private:
  std::filesystem::path streams_;
  pid_t child_ = 0;
  std::optional<int> ended_;  ///< status of the process, once it has been waited for
};

/// Makes a Program stop itself when it reaches a point for the first time; "NAME:3": for the third time.
/// @param more  further preparation of the child process
inline std::function<bool()> stopping_at(std::string const& point, std::function<bool()> const& more = {}) {
  return [=] { return ::setenv(stop_variable, point.c_str(), 1) == 0 && (!more || more()); };
}

/// Time after which a program counts as hanging. No test depends on this time, which is only a safety net.
inline constexpr std::chrono::seconds hang_limit{600};

/// Runs the program until it ends.
inline Outcome run(std::vector<std::string> arguments, std::filesystem::path const& folder,
                   std::function<bool()> const& prepare = {}) {
  return Program(std::move(arguments), folder, prepare).finish(hang_limit);
}

}  // namespace gladstone::end_to_end
