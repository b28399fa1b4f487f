#pragma once

#include <cstddef>
#include <functional>

namespace gladstone::inline base {

/// Sets the number of threads for parallel work; 0 or less: all cores. Called once, at start-up.
void set_thread_count(int threads);
int thread_count();

/// Calls body(i) once for every i in [0, count), in any order, on thread_count() threads. Tests for Ctrl-C before each
/// call; the first exception ends the loop and is rethrown to the caller.
void parallel_for(std::size_t count, std::function<void(std::size_t)> const& body);

/// Like parallel_for(), calls body(begin, end) for contiguous chunks of at most `grain` indices. The chunks depend only
/// on count and grain, not on the number of threads.
void parallel_chunks(std::size_t count, std::size_t grain,
                     std::function<void(std::size_t begin, std::size_t end)> const& body);

}  // namespace gladstone::inline base
