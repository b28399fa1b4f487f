// Every room has one inline namespace of its own (docs/architecture.md), so that a compiler's message, a stack trace
// and the documentation tell where a name is defined.
#include <gmock/gmock.h>

#include <map>
#include <regex>
#include <string>
#include <vector>

#include "tests/architecture/product_sources.h"

namespace gladstone::architecture {
namespace {

/// Returns the namespace of a room's files. Two rooms cannot have the name of their folder: `case` is a keyword, and
/// `benchmark` is a namespace of Google Benchmark.
std::string required_namespace(std::string const& path) {
  std::size_t const first = path.find('/'), second = path.find('/', first + 1);
  std::string const top = path.substr(0, first);
  if (top == "python") return "gladstone::python";
  std::string const outer = top == "cuda" ? "gladstone::cuda" : "gladstone";
  if (second == std::string::npos) return outer;
  std::string const folder = path.substr(first + 1, second - first - 1);
  static std::map<std::string, std::string> const renamed = {{"case", "cases"}, {"benchmark", "benchmarks"}};
  auto const found = renamed.find(folder);
  return outer + "::inline " + (found == renamed.end() ? folder : found->second);
}

/// Returns the namespaces opened at the start of a line that belong to another room. The texts that the build embeds
/// have a namespace of their own, and a declaration of another room's type stands in the namespace of that room.
std::vector<std::string> foreign_namespaces(std::string const& path, std::string const& text) {
  std::string const own = required_namespace(path);
  std::regex const opening(R"((?:^|\n)namespace (gladstone[\w: ]*?) \{\n(class \w+;\n\}|struct \w+;\n\})?)");
  std::vector<std::string> foreign;
  for (std::sregex_iterator at(text.begin(), text.end(), opening), end; at != end; ++at) {
    std::string const name = (*at)[1];
    bool const declares = (*at)[2].matched;
    bool const inside = name == own || name.rfind(own + "::", 0) == 0;
    if (!inside && !declares && name != "gladstone::embedded") foreign.push_back(name);
  }
  return foreign;
}

TEST(Namespaces, FollowTheFolders) {
  EXPECT_EQ(required_namespace("render/optics/lens.h"), "gladstone::inline optics");
  EXPECT_EQ(required_namespace("render/files/fields/readers/vtk.cpp"), "gladstone::inline files");
  EXPECT_EQ(required_namespace("studies/case/case.h"), "gladstone::inline cases");
  EXPECT_EQ(required_namespace("cuda/rays/device_medium.h"), "gladstone::cuda::inline rays");
  EXPECT_EQ(required_namespace("render/render.h"), "gladstone");
}

TEST(Namespaces, OfAnotherRoomAreSeen) {
  std::string const path = "render/optics/lens.h";
  EXPECT_THAT(foreign_namespaces(path, "namespace gladstone::inline optics {\n}\n"), testing::IsEmpty());
  EXPECT_THAT(foreign_namespaces(path, "namespace gladstone::inline optics::detail {\n}\n"), testing::IsEmpty());
  EXPECT_THAT(foreign_namespaces(path, "namespace gladstone::inline setup {\nclass SetupTable;\n}\n"),
              testing::IsEmpty());
  EXPECT_THAT(foreign_namespaces(path, "\nnamespace gladstone::inline light {\nstruct Ray {};\n}\n"),
              testing::ElementsAre("gladstone::inline light"));
  EXPECT_THAT(foreign_namespaces(path, "namespace gladstone {\nint x;\n}\n"), testing::ElementsAre("gladstone"));
}

TEST(Namespaces, OfEveryFileAreThoseOfItsRoom) {
  ASSERT_GT(sources().size(), 500U);
  for (auto const& [path, text] : sources()) {
    EXPECT_THAT(foreign_namespaces(path, text), testing::IsEmpty()) << path;
  }
}

}  // namespace
}  // namespace gladstone::architecture
