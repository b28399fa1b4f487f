// The table "Adding something, in one place" of CONTRIBUTING.md: the name of an entry (a field, a reader, a method, a
// command ...) may occur in its own file and in the files that its row permits, so that a new entry touches no others.
#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>

#include "tests/architecture/adding_rows.h"
#include "tests/architecture/product_sources.h"

namespace gladstone::architecture {
namespace {

namespace fs = std::filesystem;

bool names_entry(std::string const& text, std::string const& word, Row const& row) {
  return row.quoted ? text.find('"' + word + '"') != std::string::npos : names(text, word);
}

/// Returns the names of the entries of a row, with the files that define them (a header and a source of one name).
std::map<std::string, std::string> entries(Row const& row) {
  std::map<std::string, std::string> found;
  for (auto const& [path, text] : sources()) {
    if (path.rfind(row.folder + "/", 0) != 0) continue;
    for (std::sregex_iterator match(text.begin(), text.end(), row.name), end; match != end; ++match) {
      auto const group = std::find_if(match->begin() + 1, match->end(), [](auto const& sub) { return sub.matched; });
      found.emplace(group->str(), fs::path(path).replace_extension().string());
    }
  }
  return found;
}

class Adding : public testing::TestWithParam<std::size_t> {};

TEST_P(Adding, TouchesWhatTheTableNames) {
  Row const& row = rows()[GetParam()];
  std::map<std::string, std::string> const all = entries(row);
  ASSERT_GE(all.size(), row.least) << row.thing << ": the expression no longer finds the entries of " << row.folder;
  for (auto const& [name, own] : all) {
    std::set<std::string> permitted = row.registry;
    if (auto const needed = row.needed.find(name); needed != row.needed.end()) {
      permitted.insert(needed->second.begin(), needed->second.end());
    }
    for (auto const& [path, text] : sources()) {
      bool const is_oracle = path.rfind("studies/oracles/", 0) == 0;  // compares entries with formulas
      if (fs::path(path).replace_extension().string() == own || permitted.count(path) > 0 || is_oracle) continue;
      EXPECT_FALSE(names_entry(text, name, row)) << path << " names the " << row.thing << " " << name << " of " << own;
    }
  }
}

TEST_P(Adding, TheEntriesAreRegistered) {
  Row const& row = rows()[GetParam()];
  for (auto const& [name, own] : entries(row)) {
    EXPECT_TRUE(
        std::any_of(row.registry.begin(), row.registry.end(),
                    [&, &name = name](std::string const& file) { return names_entry(sources().at(file), name, row); }))
        << name << " of " << own;
  }
}

INSTANTIATE_TEST_SUITE_P(Rows, Adding, testing::Range(std::size_t{0}, rows().size()),
                         [](testing::TestParamInfo<std::size_t> const& info) {
                           std::string name = rows()[info.param].thing;
                           std::replace(name.begin(), name.end(), ' ', '_');
                           return name;
                         });

// A new fuzz target touches its row in CMakeLists.txt, and has a corpus of files.
TEST(FuzzTargets, HaveARowAndACorpus) {
  fs::path const folder = fs::path(GLADSTONE_SOURCE_DIR) / "tests/fuzz";
  std::ifstream in(folder / "CMakeLists.txt");
  std::string const text{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  std::set<std::string> rows, sources, corpora;
  std::regex const row("gladstone_fuzz_target\\((\\w+) [^)]+\\)\n");
  for (std::sregex_iterator match(text.begin(), text.end(), row), end; match != end; ++match)
    rows.insert(match->str(1));
  for (auto const& entry : fs::directory_iterator(folder)) {
    if (entry.path().extension() == ".cpp") sources.insert(entry.path().stem().string());
  }
  for (char const* const shared : {"input", "replay"}) sources.erase(shared);
  for (auto const& entry : fs::directory_iterator(folder / "corpus")) corpora.insert(entry.path().filename().string());
  EXPECT_GE(rows.size(), 15U) << "the expression no longer finds the targets";
  EXPECT_EQ(rows, sources);
  EXPECT_EQ(rows, corpora);
}

// A new figure touches the command or report that passes it to draw_figure: at most three of them.
TEST(Figures, AreNamedByThoseThatDrawThem) {
  std::size_t figures = 0;
  std::regex const declared("\\bFigure (make_\\w+)\\(");
  for (auto const& [header, declarations] : sources()) {
    if (header.rfind("studies/figures/", 0) != 0 || fs::path(header).extension() != ".h") continue;
    std::string const own = fs::path(header).replace_extension().string();
    for (std::sregex_iterator match(declarations.begin(), declarations.end(), declared), end; match != end; ++match) {
      std::string const name = match->str(1);
      if (name == "make_map_figure") continue;  // draws the panels of other figures
      std::set<std::string> callers;
      for (auto const& [path, text] : sources())
        if (names(text, name)) callers.insert(fs::path(path).replace_extension().string());
      callers.erase(own);
      EXPECT_GE(callers.size(), 1U) << name;
      EXPECT_LE(callers.size(), 3U) << name << ": " << testing::PrintToString(callers);
      ++figures;
    }
  }
  EXPECT_GE(figures, 15U) << "the expression no longer finds the figures";
}

// The figures of a comparison are removed when their case is rendered again.
TEST(Figures, OfAComparisonAreDerivedFilesOfTheCase) {
  std::string const &made = sources().at("studies/figures/comparison_figures.cpp"),
                    &listed = sources().at("studies/case/case_files.h");
  std::regex const figure("figures\\.push_back\\(\\s*\\{\"(\\w+)\"");
  std::size_t figures = 0;
  for (std::sregex_iterator match(made.begin(), made.end(), figure), end; match != end; ++match, ++figures)
    EXPECT_NE(listed.find('"' + match->str(1) + ".png\""), std::string::npos) << match->str(1);
  EXPECT_GE(figures, 4U) << "the expression no longer finds the figures";
}

// A new formula touches the rows of the sheet and the table of the page, which have the same numbers.
TEST(DesignSheet, HasTheFormulasOfItsPage) {
  auto const numbers = [](std::string const& text, std::regex const& number) {
    std::set<int> found;
    for (std::sregex_iterator match(text.begin(), text.end(), number), end; match != end; ++match)
      found.insert(std::stoi(match->str(1)));
    return found;
  };
  std::ifstream page(fs::path(GLADSTONE_SOURCE_DIR) / "docs/design.md");
  std::string table;
  for (std::string line; std::getline(page, line);)
    if (line.rfind("| F", 0) == 0) table += line.substr(0, line.find('|', 1)) + '\n';
  std::set<int> const rows = numbers(sources().at("studies/design/bos_sheet.cpp"), std::regex("\"F([0-9]+)\""));
  EXPECT_GE(rows.size(), 20U) << "the expression no longer finds the rows";
  EXPECT_EQ(rows, numbers(table, std::regex("F([0-9]+)")));
}

// Every key of a setup is an axis of a study: none is named by the code that plans and runs studies.
TEST(SweepAxes, AreNotNamedByStudies) {
  std::ifstream page(fs::path(GLADSTONE_SOURCE_DIR) / "docs/reference/setup.md");
  std::regex const heading("## `\\[+([\\w.]+)\\]+`.*"), row("\\| `(\\w+)` \\|.*");
  std::string table;
  std::size_t keys = 0;
  std::smatch match;
  for (std::string line; std::getline(page, line);) {
    if (line.rfind("## ", 0) == 0) table = std::regex_match(line, match, heading) ? match.str(1) : "";
    if (table.empty() || !std::regex_match(line, match, row)) continue;
    std::string const quoted = '"' + table + '.' + match.str(1) + '"';
    for (auto const& [path, text] : sources())
      EXPECT_TRUE(path.rfind("studies/sweep/", 0) != 0 || text.find(quoted) == std::string::npos) << path << quoted;
    ++keys;
  }
  EXPECT_GE(keys, 200U) << "the expressions no longer find the keys";
}

// Both writers of figures, for gnuplot and for browsers, know the same kinds of layers.
TEST(Figures, AreDrawnByBothWriters) {
  std::regex const kind("Layer::Kind::(\\w+):");
  std::ifstream in(fs::path(GLADSTONE_SOURCE_DIR) / "studies/drawing/figure.js");
  std::string const script{std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>()};
  std::string const &gnuplot = sources().at("studies/drawing/draw_figure.cpp"),
                    &json = sources().at("studies/drawing/figure_json.cpp");
  std::set<std::string> kinds;
  for (std::sregex_iterator match(gnuplot.begin(), gnuplot.end(), kind), end; match != end; ++match)
    kinds.insert((*match)[1]);
  EXPECT_EQ(kinds.size(), 10U);
  for (std::string const& one : kinds) {
    EXPECT_TRUE(json.find('"' + one + '"') != std::string::npos) << one;
    EXPECT_TRUE(std::regex_search(script, std::regex("layer.kind === \"" + one + '"'))) << one;
  }
}

// A figure is data; what it looks like is said once, by the writer and its templates.
TEST(Figures, AreDataWithoutCommandsOfGnuplot) {
  std::set<std::string> const writer{"studies/drawing/draw_figure.cpp", "studies/drawing/gnuplot.cpp"};
  std::regex const command("linecolor|linewidth [0-9{]|pointtype|\"set [a-z]+ |with (lines|points|boxes)");
  std::size_t found = 0;
  for (auto const& [path, text] : sources()) {
    bool const is_command = std::regex_search(text, command);
    if (writer.count(path) > 0) {
      found += is_command ? 1 : 0;
    } else {
      EXPECT_FALSE(is_command) << path << " writes commands of gnuplot";
    }
  }
  EXPECT_GE(found, 1U) << "the expression no longer finds commands";
}

}  // namespace
}  // namespace gladstone::architecture
