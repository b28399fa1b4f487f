#pragma once

#include <map>
#include <string>

namespace gladstone::architecture {

/// Sources of the product by path, without comments. Oracles may name any entry, since they compare it with a formula.
std::map<std::string, std::string> const& sources();

/// Returns whether a text contains a whole word.
bool names(std::string const& text, std::string const& word);

}  // namespace gladstone::architecture
