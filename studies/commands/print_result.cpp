#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "studies/case/json_text.h"
#include "studies/commands/command.h"
#include "studies/commands/run_warnings.h"

namespace gladstone {
namespace {

/// Appends the warnings of the run to the member "warnings" of a JSON object.
std::string with_warnings(std::string const& json) {
  nlohmann::ordered_json all = nlohmann::ordered_json::parse(json, nullptr, false);
  if (!all.is_object()) return json;
  nlohmann::ordered_json& warnings = all["warnings"];
  if (!warnings.is_array()) warnings = nlohmann::ordered_json::array();
  for (std::string const& text : recorded_warnings()) {
    // Skip warnings that the command already lists; in the log, the name of a file may precede them.
    auto const listed = [&text](nlohmann::ordered_json const& one) {
      return one.is_string() && text.ends_with(one.get_ref<std::string const&>());
    };
    if (std::none_of(warnings.begin(), warnings.end(), listed)) warnings.push_back(text);
  }
  return json_text(all);
}

}  // namespace

void print_result(GlobalOptions const& options, std::string const& json, std::string const& text) {
  std::string const chosen = options.json ? with_warnings(json) : text;
  std::fwrite(chosen.data(), 1, chosen.size(), stdout);
  if (!chosen.empty() && chosen.back() != '\n') std::fputc('\n', stdout);
}

void print_error(std::string const& text) {
  std::fwrite(text.data(), 1, text.size(), stderr);
  std::fputc('\n', stderr);
}

}  // namespace gladstone
