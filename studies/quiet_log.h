#pragma once

#include <spdlog/spdlog.h>

namespace gladstone {

/// Says nothing on the log below errors while it lives: what is warned of stands in results, or is no setup of the
/// user's.
class QuietLog {
 public:
  QuietLog() : level_(spdlog::get_level()) { spdlog::set_level(spdlog::level::err); }
  ~QuietLog() { spdlog::set_level(level_); }
  QuietLog(QuietLog const&) = delete;
  QuietLog& operator=(QuietLog const&) = delete;

 private:
  spdlog::level::level_enum level_;
};

}  // namespace gladstone
