// The scripts of shell completion and the manual page, in the programs that read them.
#include <array>
#include <cstdio>
#include <set>

#include "studies/commands/setup_keys.h"
#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsSupersetOf;
using testing::Not;

/// Runs a shell command and returns what it prints, also on stderr.
std::string output_of(std::string const& command) {
  std::string text;
  FILE* const pipe = ::popen(("{ " + command + "; } 2>&1").c_str(), "r");
  std::array<char, 4096> part{};
  while (std::size_t const size = std::fread(part.data(), 1, part.size(), pipe)) text.append(part.data(), size);
  EXPECT_EQ(::pclose(pipe), 0) << command << '\n' << text;
  return text;
}

bool is_installed(std::string const& program) {
  return std::system(("command -v " + program + " >/dev/null 2>&1").c_str()) == 0;
}

std::vector<std::string> lines_of(std::string const& text) {
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  return lines;
}

class Completion : public ProgramFixture {
 protected:
  void SetUp() override {
    ProgramFixture::SetUp();
    for (std::string const kind : {"bash", "zsh", "fish", "man"}) write(kind, succeed({"completion", kind}));
  }
  /// Returns the proposals of bash for the last of the given words.
  std::vector<std::string> in_bash(std::vector<std::string> words) const {
    std::string array;
    for (std::string const& word : words) array += " '" + word + '\'';
    write("complete", "source '" + in("bash").string() + "'\nCOMP_WORDS=(gladstone" + array + ")\nCOMP_CWORD=" +
                          std::to_string(words.size()) + "\n_gladstone\nprintf '%s\\n' \"${COMPREPLY[@]}\"\n");
    std::vector<std::string> proposals = lines_of(output_of("bash --norc '" + in("complete").string() + '\''));
    std::erase(proposals, "");
    return proposals;
  }
  /// Returns the proposals of fish for a command line, without their descriptions.
  std::vector<std::string> in_fish(std::string const& line) const {
    write("complete", "source '" + in("fish").string() + "'\ncomplete -C '" + line + "'\n");
    std::vector<std::string> proposals =
        lines_of(output_of("HOME='" + in("").string() + "' fish --no-config '" + in("complete").string() + '\''));
    for (std::string& one : proposals) one = one.substr(0, one.find('\t'));
    return proposals;
  }
};

TEST_F(Completion, OfBashProposesCommandsOptionsValuesAndKeys) {
  EXPECT_THAT(in_bash({"re"}), ElementsAre("render", "reconstruct", "report"));
  EXPECT_THAT(in_bash({"sweep", ""}), ElementsAre("plan", "run", "status", "collect"));
  EXPECT_THAT(in_bash({"sweep", "run", "--j"}), ElementsAre("--jobs", "--json"));
  EXPECT_THAT(in_bash({"render", "--"}), IsSupersetOf({"--output", "--set", "--preview", "--threads", "--help"}));
  EXPECT_THAT(in_bash({"render", "--"}), Not(Contains("--pairing"))) << "an option of correlate";
  EXPECT_THAT(in_bash({"correlate", "a.tif", "b.tif", "--pairing", ""}),
              ElementsAre("pairs", "reference", "consecutive"));
  EXPECT_THAT(in_bash({"init", ""}), IsSupersetOf({"bos", "design"}));
  EXPECT_THAT(in_bash({"init", "-o", ""}), ElementsAre()) << "a file name, which bash completes itself";
  EXPECT_THAT(in_bash({"render", "setup.toml", "--set", "lens.f_n"}), ElementsAre("lens.f_number="));
  EXPECT_THAT(in_bash({"keys", "lens.f_n"}), ElementsAre("lens.f_number"));
  EXPECT_THAT(in_bash({"render", "set"}), ElementsAre()) << "a file name";
}

// bash passes --device=c as the three words --device, = and c.
TEST_F(Completion, OfBashProposesValuesAfterAnEqualsSign) {
  for (std::vector<std::string> const& command : {std::vector<std::string>{}, {"render"}, {"sweep", "run"}}) {
    std::vector<std::string> words = command;
    words.insert(words.end(), {"--device", "=", "c"});
    EXPECT_THAT(in_bash(words), ElementsAre("cpu", "cuda"));
    words.resize(words.size() - 1);
    EXPECT_THAT(in_bash(words), ElementsAre("auto", "cpu", "cuda"));
  }
}

TEST_F(Completion, OfBashProposesEveryKeyOnce) {
  std::set<std::string> keys;
  for (SetupKeyTable const& table : setup_key_tables())
    for (SetupKey const& key : table.keys) keys.insert(key.path + '=');
  EXPECT_FALSE(keys.empty());
  EXPECT_THAT(in_bash({"render", "--set", ""}), testing::UnorderedElementsAreArray(keys));
}

TEST_F(Completion, OfFishProposesCommandsOptionsValuesAndKeys) {
  if (!is_installed("fish")) GTEST_SKIP() << "fish is not installed";
  EXPECT_THAT(in_fish("gladstone rend"), ElementsAre("render"));
  EXPECT_THAT(in_fish("gladstone sweep "), IsSupersetOf({"plan", "run", "status", "collect"}));
  EXPECT_THAT(in_fish("gladstone sweep run --job"), ElementsAre("--jobs"));
  EXPECT_THAT(in_fish("gladstone correlate --pairing "), IsSupersetOf({"pairs", "reference", "consecutive"}));
  EXPECT_THAT(in_fish("gladstone correlate --device c"), ElementsAre("cpu", "cuda"));
  EXPECT_THAT(in_fish("gladstone render setup.toml --set lens.f_n"), ElementsAre("lens.f_number="));
  EXPECT_THAT(in_fish("gladstone init des"), ElementsAre("design"));
}

// zsh reads the script without an error, and every command has its function.
TEST_F(Completion, OfZshDefinesAFunctionForEachCommand) {
  if (!is_installed("zsh")) GTEST_SKIP() << "zsh is not installed";
  write("complete", "compdef() { }\nsource '" + in("zsh").string() + "'\nprint -l ${(k)functions}\n");
  std::vector<std::string> const functions = lines_of(output_of("zsh -f '" + in("complete").string() + '\''));
  EXPECT_THAT(functions,
              IsSupersetOf({"_gladstone", "_gladstone_setup_keys", "_gladstone_render", "_gladstone_sweep_run"}));
}

TEST_F(Completion, ManualPageListsEveryCommandAndPassesTheCheck) {
  std::string const page = read("man");
  for (char const* part :
       {".SS gladstone init\n", ".SS gladstone sweep run\n", "\\fB\\-\\-pairing\\fR", ".SH EXIT STATUS"})
    EXPECT_THAT(page, HasSubstr(part));
  if (is_installed("mandoc")) {
    EXPECT_EQ(output_of("mandoc -T lint -W warning '" + in("man").string() + '\''), "");
  }
  if (is_installed("man")) {
    EXPECT_EQ(output_of("LC_ALL=C.UTF-8 MANWIDTH=100 man --warnings -E UTF-8 -l -Tutf8 -Z '" + in("man").string() +
                        "' > /dev/null"),
              "");
  }
}

TEST_F(Completion, RefusesAnotherShell) {
  expect_error({"completion", "bsh"}, 2, "arguments at kind", {"bsh", "\"bash\""});
}

}  // namespace
}  // namespace gladstone::end_to_end
