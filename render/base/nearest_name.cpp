#include "render/base/nearest_name.h"

#include <algorithm>
#include <cctype>
#include <utility>

namespace gladstone::inline base {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  // Rows of the distance table for the prefixes of `a` of length i - 2, i - 1 and i.
  std::vector<std::size_t> before_last(b.size() + 1), last(b.size() + 1), current(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    current[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      std::size_t const replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      current[j] = std::min({last[j] + 1, current[j - 1] + 1, replaced});
      bool const swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) current[j] = std::min(current[j], before_last[j - 2] + 1);
    }
    std::swap(before_last, last);
    std::swap(last, current);
  }
  return last[b.size()];
}

namespace {

/// Returns the edit distance of a candidate; nullopt if it exceeds the limit.
std::optional<std::size_t> edits_to(std::string_view word, std::string const& candidate, std::size_t share) {
  // A name without its unit suffix has distance 1 from the complete name.
  bool const without_unit =
      !word.empty() && candidate.size() > word.size() && candidate.starts_with(word) && candidate[word.size()] == '_';
  if (without_unit) return 1;
  // Words that differ in upper and lower case only have distance 1.
  auto const lower = [](unsigned char c) { return std::tolower(c); };
  if (std::ranges::equal(word, candidate, {}, lower, lower)) return word == candidate ? 0U : 1U;
  std::size_t const allowed = std::max<std::size_t>(1, std::max(word.size(), candidate.size()) / share);
  // The difference in length is a lower bound of the distance; it avoids the comparison of very long words.
  std::size_t const least = std::max(word.size(), candidate.size()) - std::min(word.size(), candidate.size());
  if (least > allowed) return std::nullopt;
  std::size_t const distance = edit_distance(word, candidate);
  if (distance > allowed) return std::nullopt;
  return distance;
}

}  // namespace

std::vector<std::string> nearest_names(std::string_view word, std::vector<std::string> const& candidates,
                                       std::size_t most, std::size_t share) {
  std::vector<std::pair<std::size_t, std::string>> near;
  for (auto const& candidate : candidates) {
    auto const edits = edits_to(word, candidate, share);
    if (edits) near.emplace_back(*edits, candidate);
  }
  std::stable_sort(near.begin(), near.end(), [](auto const& a, auto const& b) { return a.first < b.first; });
  std::vector<std::string> names;
  for (auto const& [edits, name] : near) {
    if (names.size() == most) break;
    if (std::find(names.begin(), names.end(), name) == names.end()) names.push_back(name);
  }
  return names;
}

std::optional<std::string> nearest_name(std::string_view word, std::vector<std::string> const& candidates) {
  std::vector<std::string> const nearest = nearest_names(word, candidates, 1);
  return nearest.empty() ? std::nullopt : std::optional(nearest.front());
}

std::string quoted_list(std::vector<std::string> const& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
    text += '"' + words[i] + '"';
  }
  return text;
}

}  // namespace gladstone::inline base
