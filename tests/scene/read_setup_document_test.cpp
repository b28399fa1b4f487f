#include "render/scene/read_setup_document.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <utility>

#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

TEST(SetupFile, AFileWithoutAnyKeyIsNoSetup) {
  auto const path = (std::filesystem::path(testing::TempDir()) / "empty_setup.toml").string();
  for (char const* text : {"", "\n\n", "# nothing but a remark\n"}) {
    std::ofstream(path) << text;
    try {
      read_setup_document(path);
      FAIL() << "accepted";
    } catch (SetupError const& error) {
      EXPECT_EQ(code_and_place(error.problems()[0]), "syntax at empty_setup.toml");
    }
  }
  std::filesystem::remove(path);
}

TEST(SetupFile, MissingFileAndFolderAreNamed) {
  for (auto const& [path, code] :
       {std::pair{"/no/such/setup.toml", ErrorCode::missing_file}, std::pair{"/tmp", ErrorCode::unreadable_file}}) {
    try {
      read_setup_document(path);
      FAIL() << "accepted " << path;
    } catch (SetupError const& error) {
      EXPECT_EQ(error.problems()[0].where, path);
      EXPECT_EQ(error.problems()[0].code, code);
    }
  }
}

TEST(SetupFile, FileNamesAreRelativeToTheSetup) {
  auto const folder = std::filesystem::path(testing::TempDir()) / "setup_paths";
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "case.toml") << "file = '../field.h5'\nother = '/abs/x.h5'\nempty = ''\n";
  auto setup = read_setup_document((folder / "case.toml").string());
  EXPECT_EQ(setup.root().required_path("file"), (folder.parent_path() / "field.h5").lexically_normal().string());
  EXPECT_EQ(setup.root().required_path("other"), "/abs/x.h5");
  EXPECT_EQ(setup.root().required_path("empty"), "");
  EXPECT_EQ(error_of([&] { setup.finish(); }), "invalid_value at case.toml:3:1");
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace gladstone
