#include "render/base/interrupt.h"

#include <unistd.h>

#include <atomic>
#include <csignal>

#include "render/base/error.h"

namespace gladstone::inline base {
namespace {

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

std::atomic<bool> pressed{false};  // true after the first Ctrl-C

constexpr int exit_code = 130;

extern "C" void remember_interrupt(int signal) {
  // Only a second Ctrl-C exits immediately: a worker may get Ctrl-C from the terminal and SIGTERM from its parent, and
  // SIGTERM may be sent twice.
  if (signal == SIGINT && pressed.exchange(true, std::memory_order_relaxed)) ::_exit(exit_code);
  interrupted.store(true, std::memory_order_relaxed);
}

}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, remember_interrupt);
  std::signal(SIGTERM, remember_interrupt);
  // SIGHUP remains ignored under nohup
  if (std::signal(SIGHUP, remember_interrupt) == SIG_IGN) std::signal(SIGHUP, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);  // a write beyond the file size limit then fails with EFBIG, like a full disk
}

void request_interrupt() { interrupted.store(true, std::memory_order_relaxed); }

void clear_interrupt() { interrupted.store(false, std::memory_order_relaxed); }

void throw_if_interrupted() {
  if (interrupted.load(std::memory_order_relaxed)) throw Interrupted();
}

}  // namespace gladstone::inline base
