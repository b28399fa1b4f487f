#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace gladstone::architecture {

/// Returns whether a character is part of a word: a letter, a digit or "_".
bool is_word(char c);

/// Returns whether a text contains a whole word.
bool names(std::string const& text, std::string const& word);

/// Returns the position after the character or string literal that begins at a position, or the position itself if none
/// begins there.
std::size_t end_of_literal(std::string_view source, std::size_t begin);

/// Returns a source without its comments; line numbers are unchanged.
std::string without_comments(std::string_view source);

/// Returns the sources in these folders of the tree by path, without comments.
std::map<std::string, std::string> read_sources(std::vector<std::string> const& folders);

/// Sources of the product by path, without comments.
std::map<std::string, std::string> const& sources();

}  // namespace gladstone::architecture
