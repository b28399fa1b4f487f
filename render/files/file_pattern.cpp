#include "render/files/file_pattern.h"

#include <glob.h>

#include <cctype>
#include <filesystem>
#include <system_error>

#include "render/base/error.h"

namespace gladstone::inline files {
namespace {

bool is_decimal_digit(char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; }

}  // namespace

bool is_pattern(std::string const& text) {
  std::error_code error;
  return text.find_first_of("*?[") != std::string::npos && !std::filesystem::exists(text, error);
}

std::vector<std::string> expand_pattern(std::string const& pattern) {
  glob_t found{};
  int const result = ::glob(pattern.c_str(), 0, nullptr, &found);
  std::vector<std::string> files;
  for (std::size_t i = 0; result == 0 && i < found.gl_pathc; ++i) {
    std::error_code ignored;
    if (!std::filesystem::is_directory(found.gl_pathv[i], ignored)) files.emplace_back(found.gl_pathv[i]);
  }
  ::globfree(&found);
  if (files.empty())
    throw DataError(ErrorCode::missing_file, pattern, "matches no file; check the folder and the pattern");
  return files;
}

bool is_naturally_before(std::string const& a, std::string const& b) {
  std::size_t i = 0, j = 0;
  while (i < a.size() && j < b.size()) {
    if (!is_decimal_digit(a[i]) || !is_decimal_digit(b[j])) {
      if (a[i] != b[j]) return a[i] < b[j];
      ++i;
      ++j;
      continue;
    }
    auto const number = [](std::string const& text, std::size_t& at) {
      while (at + 1 < text.size() && text[at] == '0' && is_decimal_digit(text[at + 1])) ++at;
      std::size_t const begin = at;
      while (at < text.size() && is_decimal_digit(text[at])) ++at;
      return text.substr(begin, at - begin);
    };
    std::string const x = number(a, i), y = number(b, j);
    if (x.size() != y.size()) return x.size() < y.size();
    if (x != y) return x < y;
  }
  if (a.size() - i != b.size() - j) return a.size() - i < b.size() - j;
  return a < b;
}

}  // namespace gladstone::inline files
