#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gladstone::inline base {

/// Computes the optimal string alignment distance: the smallest number of insertions, deletions, replacements and swaps
/// of adjacent characters that turn `a` into `b` (Damerau, Comm. ACM 7 (1964) 171).
std::size_t edit_distance(std::string_view a, std::string_view b);

/// Returns the candidate with the smallest edit distance to a misspelt word, the first one of equal distances. The
/// distance may be at most a third of the longer word's length, and at least 1 is allowed; a name without its unit
/// suffix ("pitch" for "pitch_mm") has distance 1. Returns nullopt if no candidate is near enough.
std::optional<std::string> nearest_name(std::string_view word, std::vector<std::string> const& candidates);

/// Returns up to `most` candidates without duplicates, in the order of their distance.
/// @param share  reciprocal of the largest allowed distance as a fraction of the longer word's length; nearest_name()
/// uses 3
std::vector<std::string> nearest_names(std::string_view word, std::vector<std::string> const& candidates,
                                       std::size_t most, std::size_t share = 3);

/// Joins words for a message: `"a", "b" or "c"`.
std::string quoted_list(std::vector<std::string> const& words);

}  // namespace gladstone::inline base
