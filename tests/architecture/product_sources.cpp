#include "tests/architecture/product_sources.h"

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <set>

namespace gladstone::architecture {

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

bool names(std::string const& text, std::string const& word) {
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    bool const begins = at == 0 || !is_word(text[at - 1]), ends = !is_word((text + " ")[at + word.size()]);
    if (begins && ends) return true;
  }
  return false;
}

std::size_t end_of_literal(std::string_view source, std::size_t begin) {
  bool const after_word = begin > 0 && is_word(source[begin - 1]);  // such as the separator of 1'000
  if (source.substr(begin, 2) == "R\"" && !after_word) {
    std::size_t const open = source.find('(', begin);
    std::string const closing = ')' + std::string(source.substr(begin + 2, open - begin - 2)) + '"';
    return std::min(source.find(closing, open), source.size() - closing.size()) + closing.size();
  }
  if (source[begin] != '"' && (source[begin] != '\'' || after_word)) return begin;
  std::size_t end = begin + 1;
  while (end < source.size() && source[end] != source[begin] && source[end] != '\n') end += source[end] == '\\' ? 2 : 1;
  return std::min(end + 1, source.size());
}

std::string without_comments(std::string_view source) {
  std::string code;
  for (std::size_t i = 0; i < source.size();) {
    std::string_view const two = source.substr(i, 2);
    std::size_t end = std::max(end_of_literal(source, i), i + 1);
    if (two != "//" && two != "/*") {
      code += source.substr(i, end - i);
    } else {
      end = two == "//" ? source.find('\n', i) : source.find("*/", i + 2);
      end = std::min(two == "/*" && end != std::string_view::npos ? end + 2 : end, source.size());
      code += ' ' + std::string(std::count(source.begin() + i, source.begin() + end, '\n'), '\n');
    }
    i = end;
  }
  return code;
}

std::map<std::string, std::string> read_sources(std::vector<std::string> const& folders) {
  namespace fs = std::filesystem;
  fs::path const root = GLADSTONE_SOURCE_DIR;
  std::map<std::string, std::string> texts;
  for (std::string const& folder : folders) {
    for (fs::directory_entry const& entry : fs::recursive_directory_iterator(root / folder)) {
      if (!std::set<std::string>{".h", ".cpp", ".cu", ".cuh"}.contains(entry.path().extension().string())) continue;
      std::ifstream in(entry.path());
      texts[entry.path().lexically_relative(root).string()] =
          without_comments(std::string(std::istreambuf_iterator<char>(in), {}));
    }
  }
  return texts;
}

std::map<std::string, std::string> const& sources() {
  static std::map<std::string, std::string> const all =
      read_sources({"render", "analysis", "cuda", "studies", "python"});
  return all;
}

}  // namespace gladstone::architecture
