#include "render/base/output_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "render/base/error.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

std::string content(fs::path const& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// A process number that no process has: that of a child that has ended.
int dead_process() {
  pid_t const child = fork();
  if (child == 0) _exit(0);
  waitpid(child, nullptr, 0);
  return child;
}

/// A fresh folder for each test.
class Output : public testing::Test {
 protected:
  void SetUp() override {
    auto const* const info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = fs::path(testing::TempDir()) / (std::string("output_") + info->test_suite_name() + info->name());
    fs::remove_all(folder_);
    fs::create_directories(folder_);
  }
  void TearDown() override { fs::remove_all(folder_); }

  std::string in_folder(std::string const& name) const { return (folder_ / name).string(); }
  std::vector<std::string> names() const {
    std::vector<std::string> found;
    for (auto const& entry : fs::directory_iterator(folder_)) found.push_back(entry.path().filename().string());
    std::sort(found.begin(), found.end());
    return found;
  }
  fs::path folder_;
};

/// While it lives no file may grow beyond some bytes: writing fails as on a full disk, for this process only.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    rlimit const limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    signal(SIGXFSZ, handler_);
  }

 private:
  void (*handler_)(int);
  rlimit before_{};
};

using OutputFileTest = Output;
using OutputFolderTest = Output;

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

TEST_F(OutputFileTest, LeftoversOfDeadRunsAreRemovedThoseOfLiveOnesStay) {
  std::string const dead = in_folder(".a.txt.partial-" + std::to_string(dead_process()));
  std::string const alive = in_folder(".a.txt.partial-" + std::to_string(getppid()));
  std::string const foreign = in_folder(".a.txt.partial-mine");
  for (auto const& path : {dead, alive, foreign}) std::ofstream(path) << "half";
  OutputFile::write_text(in_folder("a.txt"), "text");
  EXPECT_FALSE(fs::exists(dead));
  EXPECT_TRUE(fs::exists(alive));
  EXPECT_TRUE(fs::exists(foreign));
}

TEST_F(OutputFileTest, ALinkIsFollowed) {
  std::ofstream(in_folder("real.txt")) << "old";
  fs::create_symlink("real.txt", in_folder("link.txt"));
  OutputFile::write_text(in_folder("link.txt"), "new");
  EXPECT_TRUE(fs::is_symlink(in_folder("link.txt")));
  EXPECT_EQ(content(in_folder("real.txt")), "new");
}

TEST_F(OutputFileTest, FolderDeviceAndFileInThePathAreRefused) {
  EXPECT_THAT([&] { OutputFile file(folder_.string()); }, ThrowsMessage<OutputError>(HasSubstr("is a folder")));
  EXPECT_THAT([] { OutputFile file("/dev/null"); }, ThrowsMessage<OutputError>(HasSubstr("no ordinary file")));
  std::ofstream(in_folder("file")) << "x";
  EXPECT_THAT([&] { OutputFile file(in_folder("file/a.txt")); },
              ThrowsMessage<OutputError>(HasSubstr("a part of the path is a file")));
  EXPECT_THAT([] { OutputFile file(""); }, ThrowsMessage<OutputError>(HasSubstr("has no name")));
}

TEST_F(OutputFileTest, ReadOnlyFolderIsRefusedAtTheStart) {
  fs::permissions(folder_,
                  fs::perms::owner_read | fs::perms::owner_exec | fs::perms::others_read | fs::perms::others_exec);
  bool const root = geteuid() == 0;
  if (root && seteuid(65534) != 0) GTEST_SKIP() << "cannot give up root";
  EXPECT_THAT([&] { OutputFile file(in_folder("a.txt")); },
              ThrowsMessage<OutputError>(testing::AllOf(HasSubstr("Permission denied"), HasSubstr("may write to"))));
  EXPECT_THAT([&] { OutputFolder made(in_folder("case"), "m"); },
              ThrowsMessage<OutputError>(HasSubstr("Permission denied")));
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
    EXPECT_THAT([&] { OutputFile::write_text(path, std::string(5000, 'x')); },
                ThrowsMessage<OutputError>(testing::AllOf(HasSubstr("a.txt"), HasSubstr("File too large"))));
  }
  EXPECT_EQ(content(path), "old");
  EXPECT_THAT(names(), ElementsAre("a.txt"));
}

TEST_F(OutputFolderTest, ReplacesAnOlderOneOfOursOnlyAtCommit) {
  std::string const path = in_folder("case");
  for (std::string const text : {"first", "second"}) {
    OutputFolder folder(path + '/', "summary.json");
    std::ofstream(folder.temporary_path() + "/summary.json") << text;
    fs::create_directory(folder.temporary_path() + "/sub");
    EXPECT_EQ(content(path + "/summary.json"), text == "second" ? "first" : "");
    folder.commit();
    EXPECT_EQ(content(path + "/summary.json"), text);
  }
  EXPECT_THAT(names(), ElementsAre("case"));
}

TEST_F(OutputFolderTest, WithoutCommitTheOldFolderStays) {
  std::string const path = in_folder("case");
  fs::create_directory(path);
  std::ofstream(path + "/summary.json") << "old";
  {
    OutputFolder folder(path, "summary.json");
    std::ofstream(folder.temporary_path() + "/summary.json") << "half";
  }
  EXPECT_EQ(content(path + "/summary.json"), "old");
  EXPECT_THAT(names(), ElementsAre("case"));
}

TEST_F(OutputFolderTest, WhatAUserPutIntoItStaysAndWhatDependsOnTheOldGoes) {
  std::string const path = in_folder("case");
  fs::create_directories(path + "/notes/deep");
  for (std::string const name : {"summary.json", "vectors.h5", "notes.txt", "notes/deep/a.txt"}) {
    std::ofstream(path + '/' + name) << "old " + name;
  }
  fs::create_symlink("nowhere", path + "/link");
  OutputFolder folder(path, "summary.json", {"vectors.h5"});
  std::ofstream(folder.temporary_path() + "/summary.json") << "new";
  folder.commit();
  EXPECT_EQ(content(path + "/summary.json"), "new");
  EXPECT_EQ(content(path + "/notes.txt"), "old notes.txt");
  EXPECT_EQ(content(path + "/notes/deep/a.txt"), "old notes/deep/a.txt");
  EXPECT_EQ(fs::read_symlink(path + "/link"), "nowhere");
  EXPECT_FALSE(fs::exists(path + "/vectors.h5"));
  EXPECT_THAT(names(), ElementsAre("case"));
}

TEST_F(OutputFolderTest, SomebodyElsesFolderIsRefusedAtTheStartAndAtCommit) {
  std::string const path = in_folder("thesis");
  fs::create_directory(path);
  auto const refused = ThrowsMessage<OutputError>(HasSubstr("is not empty and was not made by gladstone"));
  OutputFolder early(path, "summary.json");  // an empty one is fine
  std::ofstream(path + "/chapter1.tex") << "precious";
  EXPECT_THAT([&] { OutputFolder folder(path, "summary.json"); }, refused);
  EXPECT_THAT([&] { early.commit(); }, refused);
  EXPECT_EQ(content(path + "/chapter1.tex"), "precious");
  EXPECT_THAT([&] { OutputFolder folder(path + "/chapter1.tex", "summary.json"); },
              ThrowsMessage<OutputError>(HasSubstr("is a file; name a folder")));
}

TEST_F(OutputFolderTest, AnOldFolderThatAKilledRunMovedAsideComesBack) {
  std::string const process = std::to_string(dead_process());
  std::string const aside = in_folder(".case.old-" + process);
  fs::create_directory(aside);
  std::ofstream(aside + "/summary.json") << "old";
  fs::create_directories(in_folder(".case.partial-" + process + "/sub"));
  { OutputFolder folder(in_folder("case"), "summary.json"); }
  EXPECT_EQ(content(in_folder("case") + "/summary.json"), "old");
  EXPECT_THAT(names(), ElementsAre("case"));
}

}  // namespace
}  // namespace gladstone
