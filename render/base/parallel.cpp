#include "render/base/parallel.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <memory>
#include <thread>

#include "render/base/interrupt.h"

namespace gladstone {
namespace {

int configured_threads = 0;

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
  tbb::task_arena arena(threads);
  arena.execute([&] {
    tbb::parallel_for(
        std::size_t{0}, pieces,
        [&](std::size_t piece) {
          throw_if_interrupted();
          body(piece * grain, std::min(count, (piece + 1) * grain));
        },
        tbb::auto_partitioner());
  });
}

}  // namespace gladstone
