#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace gladstone::inline commands {

/// Description of one key of a setup or study, from the tables of docs/reference/setup.md.
struct SetupKey {
  std::string path;           ///< path of the key, "lens.f_number"; without the brackets of an array of tables
  std::string unit;           ///< unit; "1": pure number; empty: not a number
  std::string default_value;  ///< TOML text of the default; empty: none, or default_words
  std::string default_words;  ///< "required", "none" or the default in words; empty: default_value
  std::string values;         ///< allowed values, in words
  std::string meaning;
  std::vector<std::string> kinds;  ///< kinds of `gladstone init` to which the key applies

  /// Returns the last part of the path: "f_number".
  std::string name() const { return path.substr(path.rfind('.') + 1); }
  bool is_required() const { return default_words.starts_with("required"); }
};

/// A table of a setup with its keys, as one section of docs/reference/setup.md.
struct SetupKeyTable {
  std::string heading;             ///< "[lens]", "[[window]]"; empty: top level of the file
  std::string condition;           ///< key that the table must contain: `kind = "file"`; empty: none
  std::vector<std::string> kinds;  ///< kinds of `gladstone init` to which the table applies
  std::vector<SetupKey> keys;
};

/// Parses a page of tables with the columns key, unit, default, values and meaning. A section counts if its heading is
/// followed by a line "Kinds: ..."; its heading is the table in backticks, then optionally a comma and the condition.
/// If the meaning of a key ends with "BOS only", the key applies only to the kinds of its table that are BOS.
std::vector<SetupKeyTable> parse_key_tables(std::string_view page);

/// Returns the tables of docs/reference/setup.md, which the build embeds in the program.
std::vector<SetupKeyTable> const& setup_key_tables();

}  // namespace gladstone::inline commands
