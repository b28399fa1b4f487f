#include "studies/case/warning_log.h"

#include <spdlog/spdlog.h>

namespace gladstone::inline cases {
namespace {

thread_local Warning const* being_logged = nullptr;

}  // namespace

void log_warning(Warning const& warning) {
  being_logged = &warning;
  spdlog::warn("{}", to_string(warning));
  being_logged = nullptr;
}

void log_warnings(Warnings const& warnings) {
  for (Warning const& warning : warnings) log_warning(warning);
}

Warning const* warning_being_logged() { return being_logged; }

}  // namespace gladstone::inline cases
