#include "studies/compare/frame_numbers.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <filesystem>

namespace gladstone::inline compare {
namespace {

bool is_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

/// Returns the only number that differs between the names, for each name; empty if there is none, or it does not
/// increase.
std::vector<long long> increasing_numbers(std::vector<NumberedName> const& names) {
  if (names.size() < 2 || !have_one_pattern(names)) return {};
  std::vector<long long> numbers;
  for (std::size_t k = 0; k < names.front().numbers.size(); ++k) {
    bool const varies = std::any_of(names.begin(), names.end(), [&](NumberedName const& name) {
      return name.numbers[k] != names.front().numbers[k];
    });
    if (!varies) continue;
    if (!numbers.empty()) return {};
    for (NumberedName const& name : names) {
      std::string const& text = name.numbers[k];
      long long number = 0;
      if (std::from_chars(text.data(), text.data() + text.size(), number).ec != std::errc{}) return {};
      if (!numbers.empty() && number <= numbers.back()) return {};
      numbers.push_back(number);
    }
  }
  return numbers;
}

}  // namespace

NumberedName split_numbers(std::string const& text) {
  NumberedName name;
  for (std::size_t i = 0; i < text.size();) {
    if (!is_digit(text[i])) {
      name.pattern += text[i++];
      continue;
    }
    std::size_t end = i;
    while (end < text.size() && is_digit(text[end])) ++end;
    while (i + 1 < end && text[i] == '0') ++i;
    name.numbers.push_back(text.substr(i, end - i));
    name.pattern += "{}";
    i = end;
  }
  return name;
}

std::vector<NumberedName> split_names(std::vector<std::string> const& files) {
  std::vector<NumberedName> names;
  for (std::string const& file : files) names.push_back(split_numbers(std::filesystem::path(file).stem().string()));
  return names;
}

bool have_one_pattern(std::vector<NumberedName> const& names) {
  return std::all_of(names.begin(), names.end(),
                     [&](NumberedName const& name) { return name.pattern == names.front().pattern; });
}

FrameIntervals::FrameIntervals(std::vector<std::string> const& files)
    : numbers_(increasing_numbers(split_names(files))) {
  std::vector<long long> intervals;
  for (std::size_t k = 0; k + 1 < numbers_.size(); ++k) intervals.push_back(numbers_[k + 1] - numbers_[k]);
  if (intervals.empty()) return;
  long long const least = *std::min_element(intervals.begin(), intervals.end());
  auto const equal = static_cast<std::size_t>(std::count(intervals.begin(), intervals.end(), least));
  if (2 * equal >= intervals.size()) usual_ = least;
}

}  // namespace gladstone::inline compare
