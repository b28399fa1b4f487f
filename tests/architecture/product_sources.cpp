#include "tests/architecture/product_sources.h"

#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>

namespace gladstone::architecture {
namespace {

namespace fs = std::filesystem;

std::string source_without_comments(fs::path const& path) {
  std::ifstream in(path);
  std::string const text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  return std::regex_replace(text, std::regex("//[^\n]*"), "");
}

}  // namespace

std::map<std::string, std::string> const& sources() {
  static std::map<std::string, std::string> const all = [] {
    std::map<std::string, std::string> texts;
    fs::path const root = GLADSTONE_SOURCE_DIR;
    for (std::string const room : {"render", "analysis", "cuda", "studies", "python"}) {
      for (fs::directory_entry const& entry : fs::recursive_directory_iterator(root / room)) {
        std::string const path = entry.path().lexically_relative(root).string();
        if (entry.is_regular_file() && path.rfind("studies/oracles/", 0) != 0) {
          if (std::set<std::string>{".h", ".cpp", ".cu", ".cuh"}.count(entry.path().extension().string()) > 0)
            texts[path] = source_without_comments(entry.path());
        }
      }
    }
    return texts;
  }();
  return all;
}

bool names(std::string const& text, std::string const& word) {
  auto const inside = [](char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; };
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    bool const begins = at == 0 || !inside(text[at - 1]), ends = !inside((text + " ")[at + word.size()]);
    if (begins && ends) return true;
  }
  return false;
}

}  // namespace gladstone::architecture
