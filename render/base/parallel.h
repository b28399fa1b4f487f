#pragma once

#include <cstddef>
#include <functional>

namespace gladstone {

/// Number of threads that parallel work uses; 0 or less: all cores. Set once at start-up.
void set_thread_count(int threads);
int thread_count();

/// Calls body(i) once for every i in [0, count), in any order, on thread_count() threads.
/// Polls for Ctrl-C between bodies; the first exception ends the loop and is rethrown here.
void parallel_for(std::size_t count, std::function<void(std::size_t)> const& body);

/// The same in contiguous pieces [begin, end) of at most `grain`; pieces are fixed by count and grain alone.
void parallel_chunks(std::size_t count, std::size_t grain,
                     std::function<void(std::size_t begin, std::size_t end)> const& body);

}  // namespace gladstone
