#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace gladstone {

/// Progress report on stderr with the remaining time. On a terminal it is a bar, redrawn at most ten times a second,
/// whose line ends on destruction; otherwise it is a line of text every 30 s. Thread-safe.
class Progress {
 public:
  Progress(std::string label, std::size_t total);
  ~Progress();
  Progress(Progress const&) = delete;
  Progress& operator=(Progress const&) = delete;

  void advance(std::size_t done = 1);

  /// Enables or disables all progress reports (--quiet and --json disable them).
  static void enable(bool on);

 private:
  void draw(std::size_t done, bool last);

  std::string label_;
  std::size_t total_;
  std::atomic<std::size_t> done_{0};
  std::chrono::steady_clock::time_point start_;
  std::atomic<long long> next_draw_ms_{200};
  std::mutex mutex_;
  bool shown_;
  bool drawn_ = false;
};

}  // namespace gladstone
