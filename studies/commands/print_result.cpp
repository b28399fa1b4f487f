#include <cstdio>

#include "studies/commands/command.h"

namespace gladstone {

void print_result(GlobalOptions const& options, std::string const& json, std::string const& text) {
  std::string const& chosen = options.json ? json : text;
  std::fwrite(chosen.data(), 1, chosen.size(), stdout);
  if (!chosen.empty() && chosen.back() != '\n') std::fputc('\n', stdout);
}

}  // namespace gladstone
