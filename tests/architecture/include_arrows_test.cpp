// The rooms and their permitted includes (docs/architecture.md): every #include of every source file must be in the
// table. Most tests here check a synthetic include; the last ones read the tree.
#include "tests/architecture/include_arrows.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "tests/architecture/product_sources.h"

namespace gladstone::architecture {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(IncludeArrows, FindIncludesWithTheirLines) {
  std::vector<Include> const found =
      includes_of("#pragma once\n#include <vector>\n  #  include \"render/base/vec.h\"  // why\n");
  ASSERT_EQ(found.size(), 2U);
  EXPECT_EQ(found[0].line, 2);
  EXPECT_EQ(found[0].target, "vector");
  EXPECT_FALSE(found[0].quoted);
  EXPECT_EQ(found[1].line, 3);
  EXPECT_EQ(found[1].target, "render/base/vec.h");
  EXPECT_TRUE(found[1].quoted);
}

TEST(IncludeArrows, LeaveCommentsOut) {
  EXPECT_THAT(includes_of("// #include <a>\n/* x\n#include <b>\n*/\nint i = 1'000; // it's\n"), IsEmpty());
}

TEST(IncludeArrows, SeeAnIncludeAfterSlashesInAString) {
  EXPECT_EQ(includes_of("char const* s = \"/*\";\n#include <a>\n").size(), 1U);
  EXPECT_EQ(includes_of("char c = '\"'; int n = 1'000;\n/* ' */ #include <a>\n").size(), 1U);
  EXPECT_EQ(includes_of("auto s = R\"x(/* \")x\";\n#include <a>\n").size(), 1U);
}

TEST(IncludeArrows, AllowWhatTheTableHas) {
  EXPECT_THAT(
      forbidden_arrows("render/base/a.h", "#include <cmath>\n#include <immintrin.h>\n#include \"render/base/b.h\"\n"),
      IsEmpty());
  EXPECT_THAT(forbidden_arrows("render/base/a.cpp", "#include <tbb/parallel_for.h>\n"), IsEmpty());
  EXPECT_THAT(forbidden_arrows("render/files/a.cpp", "#include <hdf5.h>\n#include \"render/base/vec.h\"\n"), IsEmpty());
  EXPECT_THAT(forbidden_arrows("render/light/a.cpp", "#include <Eigen/Core>\n#include \"render/files/b.h\"\n"),
              IsEmpty());
  EXPECT_THAT(forbidden_arrows("render/setup/a.cpp", "#include <toml++/toml.h>\n#include \"render/base/vec.h\"\n"),
              IsEmpty());
  EXPECT_THAT(forbidden_arrows("render/scene/a.h", "#include \"render/optics/b.h\"\n#include \"render/medium/c.h\"\n"),
              IsEmpty());
  EXPECT_THAT(
      forbidden_arrows("analysis/correlation/a.cpp", "#include <opencv2/core.hpp>\n#include \"render/base/vec.h\"\n"),
      IsEmpty());
  EXPECT_THAT(forbidden_arrows(
                  "cuda/a.cu",
                  "#include <cuda_runtime.h>\n#include \"analysis/correlation/b.h\"\n#include \"render/scene/c.h\"\n"),
              IsEmpty());
  EXPECT_THAT(
      forbidden_arrows("studies/commands/a.cpp", "#include <CLI/CLI.hpp>\n#include \"analysis/correlation/b.h\"\n"),
      IsEmpty());
  EXPECT_THAT(forbidden_arrows("studies/design/a.cpp", "#include <nlopt.hpp>\n#include \"studies/sweep/b.h\"\n"),
              IsEmpty());
  EXPECT_THAT(forbidden_arrows("studies/main.cpp", "#include <CLI/CLI.hpp>\n#include \"studies/commands/b.h\"\n"),
              IsEmpty());
  EXPECT_THAT(forbidden_arrows("tests/base/a_test.cpp", "#include <gtest/gtest.h>\n#include \"studies/b.h\"\n"),
              IsEmpty());
}

/// A file and an include line that its room does not permit.
struct Planted {
  std::string path;
  std::string include;
};

class ForbiddenArrow : public testing::TestWithParam<Planted> {};

TEST_P(ForbiddenArrow, IsSeen) {
  Planted const& planted = GetParam();
  EXPECT_THAT(forbidden_arrows(planted.path, "#include <vector>\n#include " + planted.include + "\n"),
              ElementsAre(HasSubstr(planted.path + ":2: ")));
}

INSTANTIATE_TEST_SUITE_P(
    IncludeArrows, ForbiddenArrow,
    testing::Values(
        Planted{"render/base/a.h", "\"render/medium/b.h\""},  // upwards
        Planted{"render/files/a.h", "<hdf5.h>"},              // libraries not permitted in headers
        Planted{"render/base/a.cpp", "<hdf5.h>"}, Planted{"render/base/a.h", "<Eigen/Core>"},
        Planted{"render/base/a.cpp", "\"render/files/b.h\""}, Planted{"render/files/a.cpp", "\"render/setup/b.h\""},
        Planted{"render/setup/a.cpp", "\"render/files/b.h\""}, Planted{"render/files/a.cpp", "\"render/medium/b.h\""},
        Planted{"render/files/a.h", "<OpenImageIO/imageio.h>"}, Planted{"render/setup/a.h", "<toml++/toml.h>"},
        Planted{"render/base/a.cpp", "<toml++/toml.h>"}, Planted{"render/base/a.cpp", "\"render/setup/b.h\""},
        Planted{"render/setup/a.cpp", "\"render/light/b.h\""}, Planted{"analysis/vectors/a.h", "\"render/setup/b.h\""},
        Planted{"render/base/a.h", "<tbb/parallel_for.h>"}, Planted{"render/base/a.h", "<fmt/format.h>"},
        Planted{"render/medium/a.h", "<unistd.h>"}, Planted{"render/base/a.cpp", "<opencv2/core.hpp>"},
        Planted{"render/light/a.h", "\"render/medium/b.h\""},  // only scene includes all four
        Planted{"render/medium/a.h", "\"render/optics/b.h\""}, Planted{"render/optics/a.h", "\"render/sensor/b.h\""},
        Planted{"render/sensor/a.cpp", "\"render/light/b.h\""}, Planted{"render/optics/a.h", "\"render/scene/b.h\""},
        Planted{"render/medium/a.cpp", "<hdf5.h>"},                  // only through render/files
        Planted{"render/scene/a.h", "\"render/focused_dots/b.h\""},  // renderers include the scene, not vice versa
        Planted{"render/rays/a.h", "\"render/focused_dots/b.h\""},
        Planted{"render/focused_dots/a.h", "\"render/rays/b.h\""},
        Planted{"cuda/rays/a.h", "\"render/focused_dots/b.h\""},
        Planted{"render/scene/a.h", "\"analysis/correlation/b.h\""}, Planted{"render/scene/a.cpp", "\"cuda/b.h\""},
        Planted{"analysis/correlation/a.cpp", "\"render/scene/b.h\""},  // analysis never calls the renderer
        Planted{"render/files/a.h", "\"analysis/vectors/b.h\""},
        Planted{"analysis/preparation/a.h", "\"analysis/correlation/b.h\""},
        Planted{"analysis/correlation/a.h", "<opencv2/core.hpp>"},
        Planted{"analysis/correlation/a.cpp", "\"studies/b.h\""}, Planted{"cuda/a.cu", "\"studies/b.h\""},
        Planted{"analysis/vectors/a.cpp", "\"analysis/errors/b.h\""}, Planted{"cuda/device/a.cu", "\"cuda/rays/b.h\""},
        Planted{"cuda/correlation/a.cu", "\"cuda/focused_dots/b.h\""}, Planted{"cuda/a.cpp", "<opencv2/core.hpp>"},
        Planted{"studies/case/a.cpp", "\"studies/compare/b.h\""},  // rooms of studies, downwards
        Planted{"studies/compare/a.h", "\"studies/sweep/b.h\""},
        Planted{"studies/compare/a.h", "\"studies/figures/b.h\""},
        Planted{"studies/sweep/a.cpp", "\"studies/figures/b.h\""},
        Planted{"studies/design/a.cpp", "\"studies/figures/b.h\""},
        Planted{"studies/design/a.cpp", "\"studies/drawing/b.h\""},
        Planted{"analysis/preparation/a.h", "\"render/setup/b.h\""},
        Planted{"studies/figures/a.cpp", "\"studies/report/b.h\""},
        Planted{"studies/oracles/a.cpp", "\"studies/compare/b.h\""},
        Planted{"studies/report/a.cpp", "\"studies/examples/b.h\""},
        Planted{"studies/sweep/a.cpp", "\"studies/commands/b.h\""}, Planted{"studies/compare/a.cpp", "\"cuda/b.h\""},
        Planted{"studies/sweep/a.cpp", "<CLI/CLI.hpp>"}, Planted{"studies/compare/a.cpp", "<nlopt.hpp>"},
        Planted{"studies/design/a.h", "<nlopt.hpp>"},
        Planted{"render/scene/a.cpp", "<cuda_runtime.h>"},  // CUDA headers only in cuda/
        Planted{"tests/cuda/a_test.cpp", "<cuda_runtime_api.h>"}, Planted{"studies/a.cpp", "<cufft.h>"},
        Planted{"render/base/a.h", "<cuda/std/complex>"}, Planted{"render/base/a.h", "<thrust/sort.h>"},
        Planted{"studies/a.cpp", "\"tests/support/b.h\""},  // nothing includes tests
        Planted{"render/base/a.cpp", "<gtest/gtest.h>"},
        Planted{"render/base/a.cpp", "<boost/any.hpp>"},  // an unlisted library
        Planted{"render/base/a.h", "\"vec.h\""},          // not a path from the root
        Planted{"render/light/a.h", "\"../medium/b.h\""}, Planted{"render/base/a.h", "\"render/base/../medium/b.h\""},
        Planted{"render/base/a.h", "HEADER_OF_THE_DAY"}));  // cannot be checked

TEST(IncludeArrows, RefuseCudaCodeOutsideItsRoom) {
  EXPECT_THAT(forbidden_arrows("render/scene/kernel.cu", ""), ElementsAre(HasSubstr("CUDA code outside cuda/")));
}

TEST(IncludeArrows, RefuseASourceInNoRoom) {
  EXPECT_THAT(forbidden_arrows("render/stray/a.h", ""), ElementsAre(HasSubstr("lies in no room")));
  EXPECT_THAT(forbidden_arrows("studies/stray/a.cpp", ""), ElementsAre(HasSubstr("lies in no room")));
  EXPECT_THAT(forbidden_arrows("cuda/stray/a.cu", ""), ElementsAre(HasSubstr("lies in no room")));
}

// No file is excepted: all eight exceptions of earlier versions were moved to rooms that permit their includes.
TEST(Tree, HasOnlyTheArrowsOfTheTable) {
  ASSERT_GT(sources().size(), 20U);
  std::size_t includes = 0;
  for (auto const& [path, text] : sources()) {
    includes += includes_of(text).size();
    EXPECT_THAT(forbidden_arrows(path, text), IsEmpty());
  }
  EXPECT_GT(includes, sources().size());
}

// The rooms that a target links (DEPENDS of gladstone_room()) are those that its folder may include. Rooms without a
// target are loaded at run time (image_codecs), or link gladstone::studies (the program, the Python
// module); without nvcc the folders of cuda/ are not built.
TEST(Tree, LinksTheRoomsOfTheTable) {
  std::map<std::string, std::string> folders;
  std::map<std::string, std::vector<std::string>> linked;  // targets by folder
  std::ifstream in(GLADSTONE_ROOM_DESCRIPTIONS);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string target, folder;
    words >> target >> folder;
    folders[target] = folder;
    linked[folder].assign(std::istream_iterator<std::string>(words), {});
  }
  bool const with_cuda = linked.count("cuda/device") > 0;
  for (auto const& [room, permitted] : permitted_rooms()) {
    if (room == "render/image_codecs" || room == "python/src" || room == "studies") continue;
    if (room.starts_with("cuda/") && !with_cuda) continue;
    ASSERT_TRUE(linked.count(room) > 0) << room << " has no target";
    std::set<std::string> expected = permitted, found;
    if (!with_cuda) std::erase_if(expected, [](std::string const& one) { return one.starts_with("cuda/"); });
    for (std::string const& target : linked[room]) found.insert(folders[target]);
    EXPECT_EQ(found, expected) << "DEPENDS in " << room << "/CMakeLists.txt";
    linked.erase(room);
  }
  for (auto const& [folder, targets] : linked) ADD_FAILURE() << folder << " is not a room of the table";
}

// The page for developers lists the same rooms as the table of includes, and the same permitted rooms wherever its row
// consists of names ("`render/files`, `analysis/vectors`; OpenCV in `.cpp` only") rather than of a rule ("all of
// `studies`"). A row of a room of studies omits the libraries, which every such room may include, and the folder
// `studies/` ("`drawing`, `case`").
TEST(Tree, DocumentsRoomsAndArrows) {
  std::ifstream in(std::filesystem::path(GLADSTONE_SOURCE_DIR) / "docs/architecture.md");
  std::map<std::string, std::string> documented;  // third cell of each row, by room
  for (std::string line; std::getline(in, line);) {
    std::smatch cells;
    if (!std::regex_match(line, cells, std::regex(R"(\| (`[a-z_/`, ]+) \| [^|]+ \| ([^|]+) \|)"))) continue;
    std::string const names = cells[1];
    std::regex const name("`([a-z_/]+)`");
    for (std::sregex_iterator room(names.begin(), names.end(), name), end; room != end; ++room)
      documented[(*room)[1]] = cells[2];
  }
  int compared = 0;
  for (auto const& [room, permitted] : permitted_rooms()) {
    if (room == "studies") continue;  // main.cpp
    ASSERT_TRUE(documented.contains(room)) << room << " has no row in docs/architecture.md";
    std::string const& cell = documented[room];
    if (std::regex_search(cell, std::regex("nothing|\\ball\\b|\\bas\\b|only `|\\*|same name"))) continue;
    bool const of_studies = room.starts_with("studies/");
    std::set<std::string> named, expected = permitted;
    std::regex const name(of_studies ? "`([a-z]+)`" : "`([a-z]+/[a-z_]+)`");
    for (std::sregex_iterator found(cell.begin(), cell.end(), name), end; found != end; ++found)
      named.insert((of_studies ? "studies/" : "") + found->str(1));
    std::erase_if(expected, [&](std::string const& one) {
      return of_studies ? !one.starts_with("studies/") : one == "render/base";
    });
    EXPECT_EQ(named, expected) << "row " << room << " of docs/architecture.md";
    ++compared;
  }
  EXPECT_GE(compared, 25);
}

// <nlohmann/json.hpp> takes a second to compile: a header includes json_fwd.hpp.
TEST(Tree, IncludesJsonInSourceFilesOnly) {
  std::set<std::string> including;
  for (auto const& [path, text] : sources()) {
    if (path.ends_with(".cpp") || path.ends_with(".cu")) continue;
    for (Include const& include : includes_of(text))
      if (include.target.starts_with("nlohmann/") && include.target != "nlohmann/json_fwd.hpp") including.insert(path);
  }
  EXPECT_EQ(including, std::set<std::string>{});
}

TEST(Tree, DescribesEveryRoomInAShortReadme) {
  std::filesystem::path const root = GLADSTONE_SOURCE_DIR;
  for (char const* folder : {"render", "analysis", "cuda", "studies"}) {
    for (auto const& entry : std::filesystem::directory_iterator(root / folder)) {
      if (!entry.is_directory()) continue;
      std::ifstream in(entry.path() / "README.md");
      auto const lines = std::count(std::istreambuf_iterator<char>(in), std::istreambuf_iterator<char>(), '\n');
      EXPECT_GT(lines, 0) << entry.path();
      EXPECT_LE(lines, 10) << entry.path();
    }
  }
}

using IncludesOfFiles = std::map<std::string, std::vector<Include>>;

/// Returns true if a file includes CUDA headers, directly or indirectly. @param seen files already visited
bool draws_cuda(std::string const& path, IncludesOfFiles const& files, std::set<std::string>& seen) {
  auto const file = files.find(path);
  if (file == files.end() || !seen.insert(path).second) return false;
  return std::any_of(file->second.begin(), file->second.end(), [&](Include const& include) {
    return include.quoted ? draws_cuda(include.target, files, seen) : library_of(include.target) == "CUDA";
  });
}

TEST(Tree, KeepsCudaHeadersInTheirRoom) {
  IncludesOfFiles files;
  for (auto const& [path, text] : sources()) files[path] = includes_of(text);
  for (auto const& [path, text] : read_sources({"tests"})) {
    files[path] = includes_of(text);
    EXPECT_THAT(forbidden_arrows(path, text), IsEmpty());
  }
  std::set<std::string> none_yet;
  EXPECT_TRUE(draws_cuda("cuda/device/launch.h", files, none_yet));  // the search finds an existing include
  std::set<std::string> seen;  // visited from one of them, and includes no CUDA header
  for (auto const& [path, includes] : files) {
    if (!path.starts_with("cuda/")) {
      EXPECT_FALSE(draws_cuda(path, files, seen)) << path;
    }
  }
}

TEST(Tree, NamesCudaInExactlyOneFileOfStudies) {
  std::vector<std::string> naming;
  for (auto const& [path, text] : sources()) {
    auto const includes = includes_of(text);
    bool const names_cuda = std::any_of(includes.begin(), includes.end(), [](Include const& include) {
      return include.quoted && include.target.starts_with("cuda/");
    });
    if (names_cuda && path.starts_with("studies/")) naming.push_back(path);
  }
  EXPECT_EQ(naming.size(), 1U) << testing::PrintToString(naming);
}

}  // namespace
}  // namespace gladstone::architecture
