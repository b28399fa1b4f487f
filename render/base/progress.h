#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace gladstone {

/// A progress bar with the remaining time on stderr: drawn on a terminal only, at most ten times a second.
/// Thread-safe. Ends its line on destruction.
class Progress {
 public:
  Progress(std::string label, std::size_t total);
  ~Progress();
  Progress(Progress const&) = delete;
  Progress& operator=(Progress const&) = delete;

  void advance(std::size_t done = 1);

  /// --quiet and --json switch all bars off.
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
