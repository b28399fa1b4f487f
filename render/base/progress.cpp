#include "render/base/progress.h"

#include <unistd.h>

#include <cstdio>

namespace gladstone::inline base {
namespace {

bool enabled = true;

constexpr long long line_interval_ms = 30'000;  // interval between lines if stderr is not a terminal

std::mutex drawing;  // serialises the drawing of concurrent bars on stderr

thread_local ProgressMonitor* monitor_of_thread = nullptr;

bool on_terminal() { return isatty(STDERR_FILENO) == 1; }

}  // namespace

ProgressMonitor::Report ProgressMonitor::report() const {
  std::lock_guard const lock(mutex_);
  Report report = report_;
  report.done = done_.load(std::memory_order_relaxed);
  return report;
}

void ProgressMonitor::begin(std::string const& label, std::size_t total) {
  std::lock_guard const lock(mutex_);
  report_ = {report_.number + 1, label, 0, total};
  done_.store(0, std::memory_order_relaxed);
}

ProgressMonitor::Scope::Scope(ProgressMonitor& monitor) : outer_(monitor_of_thread) { monitor_of_thread = &monitor; }

ProgressMonitor::Scope::~Scope() { monitor_of_thread = outer_; }

void Progress::enable(bool on) { enabled = on; }

Progress::Progress(std::string label, std::size_t total)
    : label_(std::move(label)), total_(total), start_(std::chrono::steady_clock::now()), shown_(enabled && total > 0) {
  if (!on_terminal()) next_draw_ms_ = line_interval_ms;
  if (total > 0 && monitor_of_thread) {
    monitor_ = monitor_of_thread;
    monitor_->begin(label_, total);
  }
}

Progress::~Progress() {
  if (drawn_) {
    draw(done_, true);
    std::fputc('\n', stderr);
  }
}

void Progress::advance(std::size_t done) {
  if (monitor_) return monitor_->advance(done);
  std::size_t const now_done = done_.fetch_add(done, std::memory_order_relaxed) + done;
  if (!shown_) return;
  auto const elapsed = std::chrono::steady_clock::now() - start_;
  long long const ms = std::chrono::duration_cast<std::chrono::milliseconds>(elapsed).count();
  long long due = next_draw_ms_.load(std::memory_order_relaxed);
  if (ms < due || !next_draw_ms_.compare_exchange_strong(due, ms + (on_terminal() ? 100 : line_interval_ms))) return;
  draw(now_done, false);
}

void Progress::draw(std::size_t done, bool last) {
  std::lock_guard const lock(drawing);
  constexpr int width = 30;
  double const fraction = static_cast<double>(done) / static_cast<double>(total_);
  double const elapsed = std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
  int const filled = static_cast<int>(fraction * width);
  std::string bar(static_cast<std::size_t>(filled), '#');
  bar.resize(width, '.');
  double const left = fraction > 0 ? elapsed * (1 - fraction) / fraction : 0;
  if (!on_terminal()) {
    std::fprintf(stderr, "%s: %d %% after %.0f s, some %.0f s left\n", label_.c_str(), static_cast<int>(100 * fraction),
                 elapsed, left);
    std::fflush(stderr);
    return;
  }
  double const seconds = last ? elapsed : left;
  std::fprintf(stderr, "\r%-24s [%s] %3d %%  %4.0f s %s ", label_.c_str(), bar.c_str(),
               static_cast<int>(100 * fraction), seconds, last ? "in all" : "left  ");
  std::fflush(stderr);
  drawn_ = true;
}

}  // namespace gladstone::inline base
