#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gladstone::inline setup {

/// Origin of setup values that were included from a file other than the setup itself.
struct SetupSource {
  std::string name;    ///< file name for messages
  std::string folder;  ///< directory to which relative file names in this file refer
};

/// Location of a setup value: line and column of a file, or a --set assignment.
struct SetupPlace {
  int line = 0;  ///< line, from 1; 0: no location
  int column = 0;
  std::string assignment;                               ///< "key.path=value" of --set; empty: from a file
  std::shared_ptr<SetupSource const> source = nullptr;  ///< file of the value; null: the setup file itself

  bool known() const { return line > 0 || !assignment.empty(); }
};

struct SetupMember;

/// One value of a parsed setup, independent of the TOML library, which only setup_node.cpp uses.
struct SetupNode {
  enum class Kind { text, integer, number, boolean, date, array, table };

  Kind kind = Kind::table;
  std::string text;  ///< value of a text; of a date as written in TOML
  long long integer = 0;
  double number = 0.0;
  bool boolean = false;
  std::vector<SetupNode> elements;   ///< elements of an array
  std::vector<SetupMember> members;  ///< keys and values of a table
  SetupPlace place;                  ///< location of the key if the value has one, else of the value

  SetupNode const* find(std::string const& key) const;
  SetupNode* find(std::string const& key);
  bool is_number() const { return kind == Kind::integer || kind == Kind::number; }
  double as_double() const { return kind == Kind::integer ? static_cast<double>(integer) : number; }
};

/// Key of a table with its value.
struct SetupMember {
  std::string key;
  SetupNode value;
};

/// Values created by the program, without a location.
SetupNode setup_text(std::string text);
SetupNode setup_number(double number);
SetupNode setup_integer(long long integer);
SetupNode setup_array(std::vector<SetupNode> elements);

/// Sets the source file of a value and of all values below it.
void set_source(SetupNode& node, std::shared_ptr<SetupSource const> const& source);

/// Maximum nesting depth: parts of a dotted key or table name, and nested brackets. Far more than any setup has and far
/// less than would exhaust the stack.
inline constexpr std::size_t most_setup_depth = 32;

/// Parses TOML 1.0.
/// @throws SetupError at name:line:column with the parser's description of the error
SetupNode parse_toml(std::string_view text, std::string const& name);

/// Parses the right-hand side of an assignment; nullopt if it is not TOML or nested deeper than most_setup_depth.
std::optional<SetupNode> parse_toml_value(std::string_view text);

/// Name of a value's kind for messages: "a text", "an array" ...
std::string kind_name(SetupNode const& node);

}  // namespace gladstone::inline setup
