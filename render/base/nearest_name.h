#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gladstone {

/// Smallest number of single-character insertions, deletions, replacements and swaps of neighbours that turn `a` into
/// `b` (optimal string alignment; Damerau, Comm. ACM 7 (1964) 171).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// The candidate that a misspelt word most likely means: the smallest edit distance, at most a third of the longer
/// word's length, the first of equals. Nothing where none is near.
std::optional<std::string> nearest_name(std::string_view word, std::vector<std::string> const& candidates);

/// All candidates that are as near, each once, the nearest first, at most so many.
/// @param share of the longer word that may differ is one over this
std::vector<std::string> nearest_names(std::string_view word, std::vector<std::string> const& candidates,
                                       std::size_t most, std::size_t share = 3);

/// `"a", "b" or "c"`, for messages.
std::string quoted_list(std::vector<std::string> const& words);

}  // namespace gladstone
