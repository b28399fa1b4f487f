#include "studies/commands/command.h"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "studies/case/json_text.h"
#include "studies/case/warning_json.h"
#include "studies/commands/run_warnings.h"

namespace gladstone::inline commands {
namespace {

/// Appends the warnings of the run to the members "warnings" and "warning_records" of a JSON object.
std::string with_warnings(std::string const& json) {
  nlohmann::ordered_json all = nlohmann::ordered_json::parse(json, nullptr, false);
  if (!all.is_object()) return json;
  nlohmann::ordered_json& warnings = all["warnings"];
  if (!warnings.is_array()) warnings = nlohmann::ordered_json::array();
  Warnings all_of_run = read_warnings(all);
  for (Warning const& logged : recorded_warnings()) {
    // Skip warnings that the command already lists; in the log, the name of a file may precede their place.
    auto const listed = [&logged](Warning const& one) { return one.code == logged.code && one.text == logged.text; };
    if (std::any_of(all_of_run.begin(), all_of_run.end(), listed)) continue;
    all_of_run.push_back(logged);
    warnings.push_back(to_string(logged));
  }
  all["warning_records"] = all_of_run;
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

}  // namespace gladstone::inline commands
