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

/// A process that catches interrupts and then waits in one call for ever, as in opening a file of a server that is
/// gone.
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
        sigsuspend(&none);  // signals come here and nowhere else; back when one has been handled
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

  /// Sends a signal. @return the exit code; -1 where it goes on, 128 + N where signal N ended it
  int after(int signal) {
    ::kill(child_, signal);
    if (goes_on()) return -1;
    int status = 0;
    waitpid(child_, &status, 0);
    child_ = 0;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

 private:
  /// Waits until it waits for the next signal, or has ended.
  bool goes_on() const {
    char x = 0;
    return read(ready_[0], &x, 1) == 1;
  }

  std::array<int, 2> ready_{};
  pid_t child_ = 0;
};

TEST(Interrupt, ASecondControlCEndsAtOnceWhateverBlocks) {
  Blocked process;
  EXPECT_EQ(process.after(SIGINT), -1) << "long work polls";
  EXPECT_EQ(process.after(SIGINT), 130);
}

// `timeout` and a study's parent send SIGTERM to who has a signal already; it still cleans up.
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
