#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gladstone {

/// A file that a value of a setup came from, where that is not the setup's own.
struct SetupSource {
  std::string name;    ///< for messages
  std::string folder;  ///< that relative file names in it refer to
};

/// Where a value of a setup stands: a line and column of the file, or a --set assignment.
struct SetupPlace {
  int line = 0;  ///< from 1; 0: nowhere
  int column = 0;
  std::string assignment;                               ///< "key.path=value" of --set, or empty
  std::shared_ptr<SetupSource const> source = nullptr;  ///< null: the setup's own file

  bool known() const { return line > 0 || !assignment.empty(); }
};

struct SetupMember;

/// One value of a parsed setup. The only file that knows the TOML library is setup_node.cpp.
struct SetupNode {
  enum class Kind { text, integer, number, boolean, date, array, table };

  Kind kind = Kind::table;
  std::string text;  ///< of a text, and of a date as written in TOML
  long long integer = 0;
  double number = 0.0;
  bool boolean = false;
  std::vector<SetupNode> elements;   ///< of an array
  std::vector<SetupMember> members;  ///< of a table
  SetupPlace place;                  ///< of the key, where there is one

  SetupNode const* find(std::string const& key) const;
  SetupNode* find(std::string const& key);
  bool is_number() const { return kind == Kind::integer || kind == Kind::number; }
  double as_double() const { return kind == Kind::integer ? static_cast<double>(integer) : number; }
};

/// A key of a table and its value.
struct SetupMember {
  std::string key;
  SetupNode value;
};

/// Values made by the program, which stand nowhere.
SetupNode setup_text(std::string text);
SetupNode setup_number(double number);
SetupNode setup_integer(long long integer);
SetupNode setup_array(std::vector<SetupNode> elements);

/// Says of a value and of all below it that they came from another file.
void set_source(SetupNode& node, std::shared_ptr<SetupSource const> const& source);

/// Most parts of a dotted key or of a table's name, and most brackets within one another: a hundred times what setups
/// have, and far from what a stack holds.
inline constexpr std::size_t most_setup_depth = 32;

/// Parses TOML 1.0. @throws SetupError with the parser's own description at name:line:column
SetupNode parse_toml(std::string_view text, std::string const& name);

/// Parses the right side of an assignment; nothing where it is not TOML, or deeper than most_setup_depth.
std::optional<SetupNode> parse_toml_value(std::string_view text);

/// Text as TOML, on one line.
std::string toml_text(SetupNode const& node);
std::string toml_text(std::string_view text);  ///< quoted and escaped
/// Shortest form that reads back to the same double, always with a point, an exponent, or as inf or nan.
std::string toml_text(double value);
/// A table as a TOML document, its own values before its tables. @pre node is a table
std::string toml_document(SetupNode const& node);
/// A key, quoted where it must be.
std::string toml_key(std::string const& key);

/// "a text", "an array" ..., for messages.
std::string kind_name(SetupNode const& node);

}  // namespace gladstone
