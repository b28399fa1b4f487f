// Every link of the documents to a file of the tree has an existing target, including the heading that it names.
#include <gmock/gmock.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

namespace gladstone::architecture {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

std::string content(fs::path const& path) {
  std::ifstream in(path);
  return {std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
}

/// Returns the targets of "](...)" in order, without external addresses ("https:").
std::vector<std::string> links_of(std::string const& text) {
  std::vector<std::string> links;
  for (std::size_t at = text.find("]("); at != std::string::npos; at = text.find("](", at + 2)) {
    std::string const link = text.substr(at + 2, text.find(')', at) - at - 2);
    if (link.find("://") == std::string::npos && link.rfind("mailto:", 0) != 0) links.push_back(link);
  }
  return links;
}

/// Returns the anchor of a heading: lower case, hyphens for spaces, punctuation removed.
std::string anchor_of(std::string const& heading) {
  std::string anchor;
  for (char const c : heading) {
    auto const letter = static_cast<unsigned char>(c);
    if (std::isalnum(letter) || c == '-' || c == '_') anchor += static_cast<char>(std::tolower(letter));
    if (c == ' ') anchor += '-';
  }
  return anchor;
}

bool has_anchor(std::string const& text, std::string const& anchor) {
  for (std::size_t line = 0; line < text.size();) {
    std::size_t const end = std::min(text.find('\n', line), text.size());
    std::size_t const title = text.find_first_not_of('#', line);
    if (title > line && title < end && text[title] == ' ' &&
        anchor_of(text.substr(title + 1, end - title - 1)) == anchor) {
      return true;
    }
    line = end + 1;
  }
  return false;
}

/// Returns the links of a document without an existing target.
std::vector<std::string> broken_links(fs::path const& document) {
  std::vector<std::string> broken;
  for (std::string const& link : links_of(content(document))) {
    std::size_t const hash = std::min(link.find('#'), link.size());
    fs::path const file = hash == 0 ? document : document.parent_path() / link.substr(0, hash);
    bool const there = fs::exists(file) && (hash == link.size() || has_anchor(content(file), link.substr(hash + 1)));
    if (!there) broken.push_back(document.filename().string() + ": " + link);
  }
  return broken;
}

TEST(DocumentLinks, AreFoundWithTheirHeadings) {
  EXPECT_THAT(links_of("see [a](docs/a.md), ![b](b.png) and [c](https://c.example/c)\n[d](#e)"),
              ElementsAre("docs/a.md", "b.png", "#e"));
  EXPECT_TRUE(has_anchor("# One\n\n## Rays, and `spots`\ntext\n", "rays-and-spots"));
  EXPECT_FALSE(has_anchor("# One\ntext: rays\n", "rays"));
}

TEST(DocumentLinks, LeadSomewhere) {
  fs::path const root = GLADSTONE_SOURCE_DIR;
  std::vector<fs::path> documents;
  for (fs::directory_entry const& entry : fs::directory_iterator(root))
    if (entry.path().extension() == ".md") documents.push_back(entry.path());
  for (char const* folder : {"docs", "data", "render", "analysis", "cuda", "studies", "python", "paper"})
    for (fs::directory_entry const& entry : fs::recursive_directory_iterator(root / folder))
      if (entry.path().extension() == ".md") documents.push_back(entry.path());
  ASSERT_GT(documents.size(), 3U);
  for (fs::path const& document : documents) EXPECT_THAT(broken_links(document), IsEmpty());
}

}  // namespace
}  // namespace gladstone::architecture
