#include "render/base/warning.h"

#include <algorithm>
#include <array>
#include <iterator>

namespace gladstone::inline base {
namespace {

/// Names of the codes, in their order.
constexpr std::array<std::string_view, 15> names{
    "assumed",     "ignored",  "approximated", "inconsistent", "implausible", "incomplete", "excluded", "low_accuracy",
    "out_of_view", "exposure", "unsuitable",   "unreliable",   "failed",      "obsolete",   "other"};
static_assert(names.size() == static_cast<std::size_t>(WarningCode::other) + 1);

}  // namespace

std::string_view warning_code_name(WarningCode code) { return names.at(static_cast<std::size_t>(code)); }

WarningCode find_warning_code(std::string_view name) {
  auto const found = std::find(names.begin(), names.end() - 1, name);
  return static_cast<WarningCode>(std::distance(names.begin(), found));
}

std::string to_string(Warning const& warning) {
  return warning.place.empty() ? warning.text : warning.place + ": " + warning.text;
}

std::vector<std::string> to_strings(Warnings const& warnings) {
  std::vector<std::string> texts;
  for (Warning const& warning : warnings) texts.push_back(to_string(warning));
  return texts;
}

Warning at_place(std::string const& outer, Warning warning) {
  warning.place = warning.place.empty() ? outer : outer + ": " + warning.place;
  return warning;
}

}  // namespace gladstone::inline base
