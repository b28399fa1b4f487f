// A function that a header declares is defined in the source file of the same name, so that a reader of one finds the
// other. The first tests check synthetic sources; the last ones read the tree.
#include "tests/architecture/declarations.h"

#include <gmock/gmock.h>

#include <set>

#include "tests/architecture/product_sources.h"

namespace gladstone::architecture {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

std::vector<std::string> names(std::string const& source, bool defined) {
  std::vector<std::string> found;
  for (FunctionSite const& site : functions_of(source))
    if (site.defined == defined) found.push_back(site.function);
  return found;
}

TEST(Declarations, AreFoundAtNamespaceScope) {
  EXPECT_THAT(names("#include <map>\n#define F(x) {\nnamespace a::inline b {\nstruct S;\nint f();\n"
                    "std::map<int, int> g(std::map<int, int> const& m, S s = {}, std::function<void(int)> h = {});\n"
                    "std::function<void(int)> k(int);\n}\n",
                    false),
              ElementsAre("a::b::f/0", "a::b::g/3", "a::b::k/1"));
}

TEST(Declarations, AreFoundAfterDefinitions) {
  EXPECT_THAT(names("S::S(int a) : a_{a}, b_(1'000) { f(); }\nconstexpr T t{{1}, 2};\nint g(char c) { return c == '{'; "
                    "}\n/* } */ int h(int a, int b) { return k(\"}\"); }\nauto s = R\"x({)x\";\nvoid l() {}\n",
                    true),
              ElementsAre("g/1", "h/2", "l/0"));
}

TEST(Declarations, ExcludeFunctionsWithoutAFileOfTheirOwn) {
  EXPECT_THAT(
      functions_of("namespace {\nint a();\n}\nstatic int b();\ninline int c() { return 1; }\n"
                   "template <class T>\nint d(T t) {}\nstruct S { int e(); };\nint S::e() { return 1; }\n"
                   "bool operator==(S const& a, S const& b) { return true; }\nint const g = h(1);\nMACRO(x);\n"),
      IsEmpty());
}

TEST(Declarations, AreReportedInTheHeaderOfAnotherFile) {
  std::map<std::string, std::string> sources{
      {"a.h", "int f(int a);\nint g();\nint generated();\n"},
      {"a.cpp", "int f(int a) { return a; }\nint f(int a, int b) { return b; }\n"},
      {"b.cpp", "int g() { return f(1); }\n"}};
  EXPECT_THAT(strayed_declarations(sources), ElementsAre("a.h: g/0 is defined in b.cpp"));
  sources["a.h"] += "int f(int a, int b);\n";
  EXPECT_EQ(strayed_declarations(sources).size(), 1U);
  sources["b.h"] = "int f(int a);\n";
  EXPECT_EQ(strayed_declarations(sources).size(), 2U);
}

TEST(Tree, DeclaresFunctionsInTheHeaderOfTheirFile) {
  std::set<std::string> used;
  for (std::string const& line : strayed_declarations(sources())) {
    std::string const header = line.substr(0, line.find(':'));
    if (registry_headers().count(header) > 0) {
      used.insert(header);
    } else {
      ADD_FAILURE() << line;
    }
  }
  EXPECT_EQ(used.size(), registry_headers().size())
      << "registries without foreign functions; only these have some: " << testing::PrintToString(used);
}

}  // namespace
}  // namespace gladstone::architecture
