#include "render/files/output_file.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "render/files/output_folder.h"
#include "tests/files/support/output.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

using OutputFileTest = Output;

TEST_F(OutputFileTest, AppearsWholeAtCommitAndNotBefore) {
  std::string const path = in_folder("a.txt");
  std::ofstream(path) << "old";
  {
    OutputFile file(path);
    std::ofstream(file.temporary_path()) << "new";
    EXPECT_EQ(content(path), "old");
    file.commit();
  }
  EXPECT_EQ(content(path), "new");
  EXPECT_THAT(names(), ElementsAre("a.txt"));
}

TEST_F(OutputFileTest, WithoutCommitTheOldFileStaysAndNothingElse) {
  std::string const path = in_folder("a.txt");
  std::ofstream(path) << "old";
  {
    OutputFile file(path);
    std::ofstream(file.temporary_path()) << "half";
  }
  EXPECT_EQ(content(path), "old");
  EXPECT_THAT(names(), ElementsAre("a.txt"));
}

TEST_F(OutputFileTest, MissingFoldersAreMadeAndRemovedAgainIfNothingComes) {
  std::string const path = in_folder("deep/er/a.txt");
  { OutputFile file(path); }
  EXPECT_THAT(names(), IsEmpty());
  OutputFile::write_text(path, "text");
  EXPECT_EQ(content(path), "text");
}

TEST_F(OutputFileTest, ALinkIsFollowed) {
  std::ofstream(in_folder("real.txt")) << "old";
  fs::create_symlink("real.txt", in_folder("link.txt"));
  OutputFile::write_text(in_folder("link.txt"), "new");
  EXPECT_TRUE(fs::is_symlink(in_folder("link.txt")));
  EXPECT_EQ(content(in_folder("real.txt")), "new");
}

TEST_F(OutputFileTest, ALinkToNothingIsFollowedToWhereItLeads) {
  fs::create_directory(in_folder("there"));
  fs::create_symlink("there/real.txt", in_folder("link.txt"));
  OutputFile::write_text(in_folder("link.txt"), "new");
  EXPECT_TRUE(fs::is_symlink(in_folder("link.txt")));
  EXPECT_EQ(content(in_folder("there/real.txt")), "new");
  fs::create_symlink("circle.txt", in_folder("circle.txt"));
  EXPECT_THAT([&] { OutputFile file(in_folder("circle.txt")); }, ThrowsOutputError("circle.txt"));
}

TEST_F(OutputFileTest, TheRightsOfTheOldFileStay) {
  std::string const path = in_folder("a.txt");
  std::ofstream(path) << "old";
  fs::permissions(path, fs::perms::owner_read | fs::perms::owner_write);
  OutputFile::write_text(path, "new");
  EXPECT_EQ(fs::status(path).permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(OutputFileTest, TheLongestNamesOfAFileSystemAreWritten) {
  std::string name;
  for (int i = 0; i < 85; ++i) name += "\u20ac";  // three bytes per character
  ASSERT_EQ(name.size(), 255u);
  OutputFile::write_text(in_folder(name), "text");
  EXPECT_THAT(names(), ElementsAre(name));
}

TEST_F(OutputFileTest, FolderDeviceAndFileInThePathAreRefused) {
  EXPECT_THAT([&] { OutputFile file(folder_.string()); }, ThrowsOutputError(folder_.string()));
  for (char const* device : {"/dev/null", "/dev/full"}) {
    EXPECT_THAT([&] { OutputFile file(device); }, ThrowsOutputError(device));
  }
  ASSERT_EQ(mkfifo(in_folder("pipe").c_str(), 0666), 0);
  EXPECT_THAT([&] { OutputFile file(in_folder("pipe")); }, ThrowsOutputError("pipe"));
  std::ofstream(in_folder("file")) << "x";
  EXPECT_THAT([&] { OutputFile file(in_folder("file/a.txt")); }, ThrowsOutputError("file/a.txt"));
  EXPECT_THAT([] { OutputFile file(""); }, ThrowsOutputError(""));
}

// /dev/stdout is a link to an open file, here an ordinary one: the process that opened it would not see a file that is
// renamed to its name.
TEST_F(OutputFileTest, NamesOfOpenFilesAreRefused) {
  int const file = open(in_folder("open").c_str(), O_RDWR | O_CREAT, 0666);
  ASSERT_GE(file, 0);
  std::string const name = "/dev/fd/" + std::to_string(file);
  EXPECT_THAT([&] { OutputFile output(name); }, ThrowsOutputError(name));
  EXPECT_THAT([&] { OutputFolder output(name, {"m", {}}); }, ThrowsOutputError(name));
  close(file);
}

TEST_F(OutputFileTest, ReadOnlyFolderIsRefusedAtTheStart) {
  fs::permissions(folder_,
                  fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
  bool const root = geteuid() == 0;
  if (root && seteuid(65534) != 0) GTEST_SKIP() << "the process cannot drop root privileges";
  EXPECT_THAT([&] { OutputFile file(in_folder("a.txt")); }, ThrowsOutputError("a.txt"));
  EXPECT_THAT([&] { OutputFolder made(in_folder("case"), {"m", {}}); }, ThrowsOutputError("case"));
  if (root) {
    ASSERT_EQ(seteuid(0), 0);
  }
  fs::permissions(folder_, fs::perms::owner_all);
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(OutputFileTest, WhatDoesNotFitLeavesTheOldFileAndAMessage) {
  std::string const path = in_folder("a.txt");
  std::ofstream(path) << "old";
  {
    FileSizeLimit const limit(1000);
    EXPECT_THAT([&] { OutputFile::write_text(path, std::string(5000, 'x')); }, ThrowsOutputError("a.txt"));
  }
  EXPECT_EQ(content(path), "old");
  EXPECT_THAT(names(), ElementsAre("a.txt"));
}

}  // namespace
}  // namespace gladstone
