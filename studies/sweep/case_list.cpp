#include "studies/sweep/case_list.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <optional>
#include <string_view>

#include "render/base/error.h"

namespace gladstone::inline sweep {
namespace {

std::optional<std::size_t> whole_number(std::string_view text) {
  std::size_t value = 0;
  auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size() ? std::optional(value) : std::nullopt;
}

}  // namespace

std::string case_list(std::vector<std::size_t> const& cases) {
  std::string text;
  for (std::size_t i = 0; i < cases.size();) {
    std::size_t end = i + 1;
    while (end < cases.size() && cases[end] == cases[end - 1] + 1) ++end;
    text += fmt::format("{}{}", text.empty() ? "" : ",", cases[i]);
    if (end > i + 1) text += fmt::format("-{}", cases[end - 1]);
    i = end;
  }
  return text;
}

std::vector<std::size_t> parse_case_list(std::string const& text, std::size_t count) {
  std::vector<std::size_t> cases;
  for (std::size_t begin = 0; begin <= text.size();) {
    std::size_t const end = std::min(text.find(',', begin), text.size());
    std::string_view const part = std::string_view(text).substr(begin, end - begin);
    std::size_t const dash = part.find('-');
    auto const first = whole_number(part.substr(0, dash));
    auto const last = dash == std::string_view::npos ? first : whole_number(part.substr(dash + 1));
    if (!first || !last || *first > *last)
      throw DataError(ErrorCode::arguments, "--case",
                      fmt::format("\"{}\" is not a list of cases; write 17, or 0-3,7", text));
    if (*last >= count)
      throw DataError(ErrorCode::arguments, "--case",
                      fmt::format("{} is not in the study, which has cases 0 to {}", *last, count - 1));
    for (std::size_t i = *first; i <= *last; ++i) cases.push_back(i);
    begin = end + 1;
  }
  std::sort(cases.begin(), cases.end());
  cases.erase(std::unique(cases.begin(), cases.end()), cases.end());
  return cases;
}

}  // namespace gladstone::inline sweep
