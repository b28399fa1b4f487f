#include "render/base/interrupt.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <functional>

#include "render/base/error.h"

namespace gladstone {
namespace {

/// Child process that catches interrupts and is then blocked in a single call, like a program that opens a file of an
/// unreachable server.
class Blocked {
 public:
  explicit Blocked(std::function<void()> const& prepare = [] {}) {
    EXPECT_EQ(pipe(ready_.data()), 0);
    child_ = fork();
    if (child_ == 0) {
      prepare();
      catch_interrupts();
      sigset_t all, none;
      sigfillset(&all);
      sigemptyset(&none);
      sigprocmask(SIG_SETMASK, &all, nullptr);
      for (;;) {
        if (write(ready_[1], "x", 1) != 1) _exit(1);
        sigsuspend(&none);  // signals are only delivered here; the call returns after one has been handled
      }
    }
    close(ready_[1]);
    EXPECT_TRUE(goes_on());
  }
  ~Blocked() {
    if (child_ <= 0) return;
    ::kill(child_, SIGKILL);
    waitpid(child_, nullptr, 0);
    close(ready_[0]);
  }
  Blocked(Blocked const&) = delete;
  Blocked& operator=(Blocked const&) = delete;

  /// Sends a signal to the process.
  /// @return exit code; 128 + N if signal N terminated it; -1 if it is still running
  int after(int signal) {
    ::kill(child_, signal);
    if (goes_on()) return -1;
    int status = 0;
    waitpid(child_, &status, 0);
    child_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  /// Waits until the process is ready for the next signal (true) or has ended (false).
  bool goes_on() const {
    char x = 0;
    return read(ready_[0], &x, 1) == 1;
  }

  std::array<int, 2> ready_{};
  pid_t child_ = 0;
};

TEST(Interrupt, ASecondControlCEndsAtOnceWhateverBlocks) {
  Blocked process;
  EXPECT_EQ(process.after(SIGINT), -1) << "the first Ctrl-C only sets a flag";
  EXPECT_EQ(process.after(SIGINT), 130);
}

// `timeout` and the parent process of a study may send SIGTERM to a process that has already received a signal; the
// process must still clean up.
TEST(Interrupt, OtherSignalsAreOnlyRememberedHoweverManyCome) {
  Blocked process;
  for (int const signal : {SIGTERM, SIGTERM, SIGHUP, SIGHUP, SIGINT, SIGTERM}) EXPECT_EQ(process.after(signal), -1);
  EXPECT_EQ(process.after(SIGINT), 130);
}

TEST(Interrupt, EachSignalIsPolledFor) {
  for (int const signal : {SIGINT, SIGTERM, SIGHUP}) {
    EXPECT_EXIT(
        {
          catch_interrupts();
          throw_if_interrupted();
          raise(signal);
          try {
            throw_if_interrupted();
          } catch (Interrupted const&) {
            _exit(7);
          }
          _exit(1);
        },
        testing::ExitedWithCode(7), "");
  }
}

TEST(Interrupt, AHangUpThatIsIgnoredStaysSo) {
  EXPECT_EXIT(
      {
        signal(SIGHUP, SIG_IGN);
        catch_interrupts();
        raise(SIGHUP);
        throw_if_interrupted();
        _exit(7);
      },
      testing::ExitedWithCode(7), "");
}

}  // namespace
}  // namespace gladstone
