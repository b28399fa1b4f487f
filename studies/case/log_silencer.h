#pragma once

#include <spdlog/spdlog.h>

namespace gladstone::inline cases {

/// RAII guard that silences log messages below `error`, for internally constructed setups and for warnings that are
/// reported elsewhere.
class LogSilencer {
 public:
  LogSilencer() : level_(spdlog::get_level()) { spdlog::set_level(spdlog::level::err); }
  ~LogSilencer() { spdlog::set_level(level_); }
  LogSilencer(LogSilencer const&) = delete;
  LogSilencer& operator=(LogSilencer const&) = delete;

 private:
  spdlog::level::level_enum level_;
};

}  // namespace gladstone::inline cases
