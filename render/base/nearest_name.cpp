#include "render/base/nearest_name.h"

#include <algorithm>

namespace gladstone {

std::size_t edit_distance(std::string_view a, std::string_view b) {
  // Rows of the distance table for the prefixes of a that end two before, one before and at the current character.
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

std::optional<std::string> nearest_name(std::string_view word, std::vector<std::string> const& candidates) {
  std::optional<std::string> nearest;
  std::size_t smallest = 0;
  for (auto const& candidate : candidates) {
    // a name without its unit means the one with it
    bool const without_unit =
        !word.empty() && candidate.size() > word.size() && candidate.starts_with(word) && candidate[word.size()] == '_';
    std::size_t const allowed = std::max<std::size_t>(1, std::max(word.size(), candidate.size()) / 3);
    // no fewer edits than the lengths differ by: a word as long as a book is compared with nothing
    std::size_t const least = std::max(word.size(), candidate.size()) - std::min(word.size(), candidate.size());
    if (!without_unit && (least > allowed || (nearest && least >= smallest))) continue;
    std::size_t const distance = without_unit ? 1 : edit_distance(word, candidate);
    if (distance > allowed || (nearest && distance >= smallest)) continue;
    nearest = candidate;
    smallest = distance;
  }
  return nearest;
}

std::string quoted_list(std::vector<std::string> const& words) {
  std::string text;
  for (std::size_t i = 0; i < words.size(); ++i) {
    if (i > 0) text += i + 1 == words.size() ? " or " : ", ";
    text += '"' + words[i] + '"';
  }
  return text;
}

}  // namespace gladstone
