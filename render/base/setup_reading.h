#pragma once

#include <string>
#include <vector>

#include "render/base/setup_state.h"

/// What the readers of a SetupTable's keys share; nothing else includes it.
namespace gladstone::setup_reading {

inline std::vector<std::string> below(std::vector<std::string> path, std::string const& key) {
  path.push_back(key);
  return path;
}

/// Marks a key as known to its table.
inline SetupRecord::Entry& known(SetupDocument::State& state, std::vector<std::string> const& table,
                                 std::string const& key) {
  return state.record_of(table).entry(key);
}

/// The value of a key being read; null where it is absent.
inline SetupNode const* read(SetupDocument::State& state, std::vector<std::string> const& table,
                             std::string const& key) {
  known(state, table, key).read = true;
  return state.find(below(table, key));
}

/// Remembers what a key came to.
inline void use(SetupDocument::State& state, std::vector<std::string> const& table, std::string const& key,
                std::string const& value) {
  auto& entry = known(state, table, key);
  if (!entry.resolved) entry.value = value;
}

/// What a key came to in the end.
inline void settle(SetupDocument::State& state, std::vector<std::string> const& table, std::string const& key,
                   std::string const& value) {
  auto& entry = known(state, table, key);
  entry.value = value;
  entry.resolved = true;
}

/// A default in SI as a setup writes it: to 12 digits, without what products with a unit leave of rounding.
double in_unit(double si, double unit);

/// What a number breaks of its range, with the rule; empty where it keeps it.
std::string broken_rule(double value, Range const& range);
/// Some number that the range allows.
double harmless(Range const& range);
/// "must be a number (it is a text)", with a hint where quotes are the mistake.
std::string wrong_kind(std::string const& wanted, SetupNode const& node);
std::string wrong_integer(SetupNode const& node);
/// "must be at least 1 and at most 9"
std::string between(long long low, long long high);
std::string wrong_word(std::string const& text, std::vector<std::string> const& words);

inline std::string boolean_text(bool value) { return value ? "true" : "false"; }

}  // namespace gladstone::setup_reading
