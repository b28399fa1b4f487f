#include "render/base/interrupt.h"

#include <atomic>
#include <csignal>

#include "render/base/error.h"

namespace gladstone {
namespace {

std::atomic<bool> interrupted{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler may only touch lock-free atomics");

extern "C" void remember_interrupt(int) { interrupted.store(true, std::memory_order_relaxed); }

}  // namespace

void catch_interrupts() {
  std::signal(SIGINT, remember_interrupt);
  std::signal(SIGTERM, remember_interrupt);
  std::signal(SIGXFSZ, SIG_IGN);  // a file over the user's limit is a failed write, reported like a full disk
}

void throw_if_interrupted() {
  if (interrupted.load(std::memory_order_relaxed)) throw Interrupted();
}

}  // namespace gladstone
