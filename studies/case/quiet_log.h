#pragma once

#include <spdlog/spdlog.h>

namespace gladstone {

/// RAII guard that silences log messages below `error`, for internally constructed setups and for warnings that are
/// reported elsewhere.
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
