#pragma once

#include <string>
#include <string_view>

#include "render/setup/setup_node.h"

/// Formatting of setup values as TOML.
namespace gladstone::inline setup {

/// Formats a value as TOML on one line.
std::string toml_text(SetupNode const& node);
std::string toml_text(std::string_view text);  ///< a TOML string, quoted and escaped

/// Formats a number in the shortest form that reads back to the same double; always with a decimal point or exponent,
/// or as inf or nan, so that it remains a float in TOML.
std::string toml_text(double value);

/// Formats a table as a TOML document, its values before its sub-tables. @pre node is a table
std::string toml_document(SetupNode const& node);

/// Formats a key, quoted if necessary.
std::string toml_key(std::string const& key);

}  // namespace gladstone::inline setup
