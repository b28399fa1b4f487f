#pragma once

#include <string>
#include <vector>

#include "render/setup/setup_state.h"

/// Helpers shared by the source files of SetupTable; not for other files.
namespace gladstone::inline setup::setup_reading {

inline std::vector<std::string> below(std::vector<std::string> path, std::string const& key) {
  path.push_back(key);
  return path;
}

/// Returns the record of a key of a table, creating it: the key is known from now on.
inline SetupRecord::Entry& known(SetupDocument::State& state, std::vector<std::string> const& table,
                                 std::string const& key) {
  return state.find_or_create_record(table).entry(key);
}

/// Marks a key as read and returns its value; null if it is absent.
inline SetupNode const* read(SetupDocument::State& state, std::vector<std::string> const& table,
                             std::string const& key) {
  known(state, table, key).read = true;
  return state.find(below(table, key));
}

/// Records the value used for a key, unless settle() has set the final one.
inline void use(SetupDocument::State& state, std::vector<std::string> const& table, std::string const& key,
                std::string const& value) {
  auto& entry = known(state, table, key);
  if (!entry.resolved) entry.value = value;
}

/// Records the final value of a key.
inline void settle(SetupDocument::State& state, std::vector<std::string> const& table, std::string const& key,
                   std::string const& value) {
  auto& entry = known(state, table, key);
  entry.value = value;
  entry.resolved = true;
}

/// Converts a default from SI to the unit of its key, rounded to 12 significant digits to remove rounding errors of the
/// conversion.
double in_unit(double si, double unit);

/// Checks a number against a range. @return the violated rule ("must be at least 1"); empty if the number is allowed
std::string broken_rule(double value, Range const& range);
/// Returns a number within a range, to continue reading after an error.
double harmless(Range const& range);
/// Message about a value of the wrong kind: "must be a number (it is a text)", with a hint if only the quotes are
/// wrong.
std::string wrong_kind(std::string const& wanted, SetupNode const& node);
std::string wrong_integer(SetupNode const& node);
/// Message about an integer out of range: "must be at least 1 and at most 9".
std::string between(long long low, long long high);
std::string wrong_word(std::string const& text, std::vector<std::string> const& words);

inline std::string boolean_text(bool value) { return value ? "true" : "false"; }

}  // namespace gladstone::inline setup::setup_reading
