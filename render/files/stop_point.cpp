#include "render/files/stop_point.h"

#include <signal.h>
#include <stdlib.h>

#include <atomic>
#include <string>

namespace gladstone::inline files {
namespace {

struct WantedStop {
  std::string name;
  int pass = 1;
};

WantedStop wanted_stop() {
  char const* const given = ::getenv(stop_variable);
  std::string const text = given ? given : "";
  std::size_t const colon = text.find(':');
  if (colon == std::string::npos) return {text, 1};
  return {text.substr(0, colon), static_cast<int>(std::strtol(text.c_str() + colon + 1, nullptr, 10))};
}

}  // namespace

void stop_point(char const* name) {
  static WantedStop const wanted = wanted_stop();
  static std::atomic<int> passes{0};
  if (wanted.name == name && ++passes == wanted.pass) ::raise(SIGSTOP);
}

}  // namespace gladstone::inline files
