#include "studies/commands/run_warnings.h"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>
#include <mutex>

namespace gladstone {
namespace {

class WarningSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  std::vector<std::string> texts() {
    std::lock_guard const lock(mutex_);
    return texts_;
  }

 private:
  void sink_it_(spdlog::details::log_msg const& message) override {
    if (message.level != spdlog::level::warn) return;
    std::string text(message.payload.data(), message.payload.size());
    if (std::find(texts_.begin(), texts_.end(), text) == texts_.end()) texts_.push_back(std::move(text));
  }
  void flush_() override {}

  std::vector<std::string> texts_;
};

std::shared_ptr<WarningSink> const& sink() {
  static std::shared_ptr<WarningSink> const only = std::make_shared<WarningSink>();
  return only;
}

}  // namespace

void record_warnings(spdlog::logger& log) { log.sinks().push_back(sink()); }

std::vector<std::string> recorded_warnings() { return sink()->texts(); }

}  // namespace gladstone
