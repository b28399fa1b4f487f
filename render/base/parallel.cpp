#include "render/base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <map>
#include <memory>
#include <mutex>
#include <thread>
#include <vector>

#include "render/base/interrupt.h"

namespace gladstone::inline base {
namespace {

int configured_threads = 0;

/// Arenas of the loops, by number of threads. oneTBB does not free all the memory of a destroyed arena in which workers
/// ran (8 KB each with version 2021.8), so that arenas are reused. Concurrent and nested loops have arenas of their
/// own.
class ArenaPool {
 public:
  using Arena = std::unique_ptr<tbb::task_arena>;

  /// The pool, which is never destroyed, since oneTBB may be unloaded before static objects are destroyed.
  static ArenaPool& instance() {
    static ArenaPool& pool = *new ArenaPool;
    return pool;
  }
  /// Returns an idle arena, or a new one if there is none.
  Arena acquire(int threads) {
    std::lock_guard const lock(mutex_);
    std::vector<Arena>& idle = idle_[threads];
    if (idle.empty()) {
      idle.reserve(idle.capacity() + 1);  // reserve a place for every arena, so that release() allocates nothing
      return std::make_unique<tbb::task_arena>(threads);
    }
    Arena arena = std::move(idle.back());
    idle.pop_back();
    return arena;
  }
  void release(int threads, Arena arena) {
    std::lock_guard const lock(mutex_);
    idle_[threads].push_back(std::move(arena));
  }

 private:
  std::mutex mutex_;
  std::map<int, std::vector<Arena>> idle_;
};

/// RAII guard that takes an arena of the ArenaPool for one loop, and returns it afterwards.
class LoopArena {
 public:
  explicit LoopArena(int threads) : threads_(threads), arena_(ArenaPool::instance().acquire(threads)) {}
  ~LoopArena() { ArenaPool::instance().release(threads_, std::move(arena_)); }
  LoopArena(LoopArena const&) = delete;
  LoopArena& operator=(LoopArena const&) = delete;
  tbb::task_arena& operator*() const { return *arena_; }

 private:
  int threads_;
  ArenaPool::Arena arena_;
};

}  // namespace

void set_thread_count(int threads) { configured_threads = threads; }

int thread_count() {
  return configured_threads > 0 ? configured_threads
                                : std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
}

void parallel_for(std::size_t count, std::function<void(std::size_t)> const& body) {
  parallel_chunks(count, 1, [&](std::size_t begin, std::size_t) { body(begin); });
}

void parallel_chunks(std::size_t count, std::size_t grain,
                     std::function<void(std::size_t begin, std::size_t end)> const& body) {
  if (count == 0) return;
  std::size_t const pieces = (count + grain - 1) / grain;
  int const threads = thread_count();
  tbb::global_control limit(tbb::global_control::max_allowed_parallelism, static_cast<std::size_t>(threads));
  LoopArena const arena(threads);
  (*arena).execute([&] {
    tbb::parallel_for(
        std::size_t{0}, pieces,
        [&](std::size_t piece) {
          throw_if_interrupted();
          body(piece * grain, std::min(count, (piece + 1) * grain));
        },
        tbb::auto_partitioner());
  });
}

}  // namespace gladstone::inline base
