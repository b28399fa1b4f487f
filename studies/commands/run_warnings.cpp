#include "studies/commands/run_warnings.h"

#include <spdlog/sinks/base_sink.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <memory>
#include <mutex>

#include "studies/case/warning_log.h"

namespace gladstone::inline commands {
namespace {

class WarningSink final : public spdlog::sinks::base_sink<std::mutex> {
 public:
  Warnings warnings() {
    std::lock_guard const lock(mutex_);
    return warnings_;
  }

 private:
  void sink_it_(spdlog::details::log_msg const& /*message*/) override {
    Warning const* const warning = warning_being_logged();
    if (!warning || std::find(warnings_.begin(), warnings_.end(), *warning) != warnings_.end()) return;
    warnings_.push_back(*warning);
  }
  void flush_() override {}

  Warnings warnings_;
};

std::shared_ptr<WarningSink> const& sink() {
  static std::shared_ptr<WarningSink> const only = std::make_shared<WarningSink>();
  return only;
}

}  // namespace

void record_warnings(spdlog::logger& log) { log.sinks().push_back(sink()); }

Warnings recorded_warnings() { return sink()->warnings(); }

}  // namespace gladstone::inline commands
