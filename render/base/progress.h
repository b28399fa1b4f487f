#pragma once

#include <atomic>
#include <chrono>
#include <cstddef>
#include <mutex>
#include <string>

namespace gladstone::inline base {

/// Receives the progress reports of one thread (see Scope) in place of stderr. Other threads may read them at any time.
class ProgressMonitor {
 public:
  ProgressMonitor() = default;
  ProgressMonitor(ProgressMonitor const&) = delete;
  ProgressMonitor& operator=(ProgressMonitor const&) = delete;

  /// Progress of the computation that began last.
  struct Report {
    std::size_t number = 0;  ///< number of computations begun so far; 0: none
    std::string label;
    std::size_t done = 0, total = 0;
  };
  Report report() const;

  /// RAII guard: the Progress objects made by this thread report to `monitor`.
  class Scope {
   public:
    explicit Scope(ProgressMonitor& monitor);
    ~Scope();
    Scope(Scope const&) = delete;
    Scope& operator=(Scope const&) = delete;

   private:
    ProgressMonitor* outer_;
  };

 private:
  friend class Progress;
  void begin(std::string const& label, std::size_t total);
  void advance(std::size_t done) { done_.fetch_add(done, std::memory_order_relaxed); }

  mutable std::mutex mutex_;
  Report report_;
  std::atomic<std::size_t> done_{0};
};

/// Progress report on stderr with the remaining time. On a terminal it is a bar, redrawn at most ten times a second,
/// whose line ends on destruction; otherwise it is a line of text every 30 s. Thread-safe. A
/// ProgressMonitor of the thread receives it in place of stderr.
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
  bool shown_;
  bool drawn_ = false;
  ProgressMonitor* monitor_ = nullptr;
};

}  // namespace gladstone::inline base
