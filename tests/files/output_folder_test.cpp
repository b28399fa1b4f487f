#include "render/files/output_folder.h"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <stdio.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>

#include "studies/case/write_case.h"
#include "tests/files/support/output.h"
#include "tests/support/expect_error.h"

namespace {

int renames_until_death = -1, renames_until_failure = -1;  // -1: disabled

}  // namespace

/// Replaces rename() of the C library in this test: a process can be killed before any of its renames, or a rename can
/// fail.
extern "C" int rename(char const* from, char const* to) noexcept {
  if (renames_until_death >= 0 && renames_until_death-- == 0) _exit(42);
  if (renames_until_failure >= 0 && renames_until_failure-- == 0) {
    errno = EBUSY;
    return -1;
  }
  return static_cast<int>(syscall(SYS_renameat, AT_FDCWD, from, AT_FDCWD, to));
}

namespace gladstone {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

FolderContent const content_of_case{"setup.toml", {"vectors.h5"}};

class OutputFolderTest : public Output {
 protected:
  /// Writes a complete case: three files that contain their version, one of them in a subdirectory.
  void write_case(std::string const& version, bool vectors = false) const {
    OutputFolder folder(in_folder("case"), content_of_case);
    stage(folder, version);
    if (vectors) std::ofstream(folder.temporary_path() + "/vectors.h5") << version;
    folder.commit();
  }
  static void stage(OutputFolder const& folder, std::string const& version) {
    fs::create_directory(folder.temporary_path() + "/maps");
    for (std::string const name : {"/setup.toml", "/flow.tif", "/maps/a.dat"}) {
      std::ofstream(folder.temporary_path() + name) << version;
    }
  }
  std::string read(std::string const& name) const { return content(folder_ / "case" / name); }
  bool is_of(std::string const& version) const {
    return read("setup.toml") == version && read("flow.tif") == version && read("maps/a.dat") == version;
  }
  bool has(std::string const& name) const { return fs::exists(fs::symlink_status(folder_ / "case" / name)); }

  /// Writes an old case with vectors and a file of the user.
  void write_old_case() const {
    fs::remove_all(folder_ / "case");
    write_case("old");
    write("case/vectors.h5", "old");
    write("case/notes.txt", "mine");
  }
  /// Replaces the case in a process that is killed before one of its renames. @return true if the process ended
  /// normally
  bool replace_and_die(int rename) const {
    pid_t const child = fork();
    if (child == 0) {
      renames_until_death = rename;
      write_case("new");
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
  }
};

TEST_F(OutputFolderTest, AppearsWholeAtCommitAndNotBefore) {
  {
    OutputFolder folder(in_folder("case"), content_of_case);
    stage(folder, "new");
    EXPECT_FALSE(fs::exists(folder_ / "case"));
    folder.commit();
  }
  EXPECT_TRUE(is_of("new"));
  EXPECT_THAT(names(), ElementsAre("case"));
  EXPECT_THAT(names("case"), ElementsAre("flow.tif", "maps", "setup.toml"));
}

TEST_F(OutputFolderTest, ReplacesTheFilesOfAnOlderOneOnlyAtCommit) {
  write_old_case();
  {
    OutputFolder folder(in_folder("case") + '/', content_of_case);
    stage(folder, "new");
    EXPECT_TRUE(is_of("old"));
    folder.commit();
    EXPECT_TRUE(is_of("new"));
  }
  EXPECT_THAT(names(), ElementsAre("case"));
  EXPECT_THAT(names("case"), ElementsAre("flow.tif", "maps", "notes.txt", "setup.toml"));
}

TEST_F(OutputFolderTest, WithoutCommitTheOldFolderStaysAndNothingElse) {
  write_old_case();
  { stage(OutputFolder(in_folder("case"), content_of_case), "half"); }
  EXPECT_TRUE(is_of("old"));
  EXPECT_THAT(names("case"), ElementsAre("flow.tif", "maps", "notes.txt", "setup.toml", "vectors.h5"));
  { stage(OutputFolder(in_folder("deep/er/case"), content_of_case), "half"); }
  EXPECT_THAT(names(), ElementsAre("case"));
}

TEST_F(OutputFolderTest, PreservesUserFilesRemovesDerivedFiles) {
  write_old_case();
  fs::create_directories(folder_ / "case/maps/deep");
  write("case/maps/deep/b.dat", "mine too");
  fs::create_symlink("nowhere", folder_ / "case/link");
  write_case("new");
  EXPECT_EQ(read("notes.txt"), "mine");
  EXPECT_EQ(read("maps/deep/b.dat"), "mine too");
  EXPECT_EQ(fs::read_symlink(folder_ / "case/link"), "nowhere");
  EXPECT_FALSE(has("vectors.h5"));
  write_case("newer", true);
  EXPECT_EQ(read("vectors.h5"), "newer") << "a derived file that is written with the others is kept";
}

// The directory itself is retained, since the working directory of a shell, a mount, permissions, owner and access list
// belong to it.
TEST_F(OutputFolderTest, TheFolderStaysItselfWithItsRights) {
  for (bool const empty : {true, false}) {
    fs::remove_all(folder_ / "case");
    if (empty) fs::create_directory(folder_ / "case");
    if (!empty) write_old_case();
    fs::permissions(folder_ / "case", fs::perms::owner_all | fs::perms::group_read | fs::perms::set_gid);
    struct stat before {};
    struct stat after {};
    ASSERT_EQ(stat(in_folder("case").c_str(), &before), 0);
    fs::path const home = fs::current_path();
    fs::current_path(folder_ / "case");
    {
      OutputFolder folder(".", content_of_case);
      stage(folder, "new");
      folder.commit();
    }
    EXPECT_TRUE(fs::exists("setup.toml")) << "seen from the working directory";
    fs::current_path(home);
    EXPECT_TRUE(is_of("new"));
    ASSERT_EQ(stat(in_folder("case").c_str(), &after), 0);
    EXPECT_EQ(before.st_ino, after.st_ino);
    EXPECT_EQ(before.st_mode, after.st_mode);
  }
}

TEST_F(OutputFolderTest, AWritableFolderInAnUnwritableOneIsWritten) {
  write_old_case();
  if (geteuid() == 0) {
    for (auto const& entry : fs::recursive_directory_iterator(folder_)) {
      ASSERT_EQ(lchown(entry.path().c_str(), 65534, 65534), 0);
    }
  }
  ASSERT_EQ(chmod(folder_.c_str(), 0555), 0);
  bool const root = geteuid() == 0;
  if (root && seteuid(65534) != 0) GTEST_SKIP() << "the process cannot drop root privileges";
  EXPECT_NO_THROW(write_case("new"));
  if (root) {
    ASSERT_EQ(seteuid(0), 0);
  }
  fs::permissions(folder_, fs::perms::owner_all);
  EXPECT_TRUE(is_of("new"));
  EXPECT_THAT(names(), ElementsAre("case"));
}

TEST_F(OutputFolderTest, AMountedFolderIsWritten) {
  fs::create_directory(folder_ / "case");
  pid_t const child = fork();
  if (child == 0) {
    bool const mounted = unshare(CLONE_NEWNS) == 0 && mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                         mount("none", in_folder("case").c_str(), "tmpfs", 0, "size=1m") == 0;
    if (!mounted) _exit(77);
    fs::create_directory(folder_ / "case/lost+found");  // exists on a freshly formatted disk
    bool good = false;
    try {
      write_case("old");
      good = is_of("old");
      write_case("new");
      good = good && is_of("new");
    } catch (std::exception const& error) {
      fprintf(stderr, "%s\n", error.what());
      good = false;
    }
    _exit(good ? 0 : 1);
  }
  int status = 0;
  waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 77)
    GTEST_SKIP() << "mount namespaces are not available; see TheFolderStaysItselfWithItsRights";
  EXPECT_EQ(WEXITSTATUS(status), 0);
}

TEST_F(OutputFolderTest, UnrelatedFolderIsRejected) {
  fs::create_directory(folder_ / "case");
  auto const refused = ThrowsOutputError("case");
  OutputFolder early(in_folder("case"), content_of_case);  // an empty directory is accepted
  write("case/chapter1.tex", "precious");
  EXPECT_THAT([&] { OutputFolder folder(in_folder("case"), content_of_case); }, refused);
  EXPECT_THAT([&] { early.commit(); }, refused);
  EXPECT_EQ(read("chapter1.tex"), "precious");
  EXPECT_THAT([&] { OutputFolder folder(in_folder("case/chapter1.tex"), content_of_case); },
              ThrowsOutputError("chapter1.tex"));
  EXPECT_THAT([&] { OutputFolder folder("/dev/null", content_of_case); }, ThrowsOutputError("/dev/null"));
}

TEST_F(OutputFolderTest, AFolderOfTheUsersInAFilesPlaceIsRefusedWithNothingMoved) {
  write_old_case();
  fs::remove(folder_ / "case/flow.tif");
  fs::create_directory(folder_ / "case/flow.tif");
  write("case/flow.tif/mine", "mine");
  EXPECT_THAT([&] { write_case("new"); }, ThrowsOutputError("flow.tif"));
  EXPECT_EQ(read("setup.toml"), "old");
  EXPECT_EQ(read("flow.tif/mine"), "mine");
}

TEST_F(OutputFolderTest, OfTwoWritersTheLastOneWinsAndNothingIsLeft) {
  for (bool const there : {false, true}) {
    if (there) write_old_case();
    {
      OutputFolder one(in_folder("case"), content_of_case), other(in_folder("case"), content_of_case);
      stage(one, "one");
      stage(other, "other");
      one.commit();
      EXPECT_TRUE(is_of("one"));
      other.commit();
      EXPECT_TRUE(is_of("other"));
    }
    EXPECT_THAT(names(), ElementsAre("case"));
    EXPECT_EQ(names("case").front(), "flow.tif") << "no hidden file";
    fs::remove_all(folder_ / "case");
  }
}

TEST_F(OutputFolderTest, RemovesAbandonedFilesOfItsContent) {
  write_old_case();
  pid_t const child = fork();
  if (child == 0) {
    Partial const vectors(in_folder("case"), ".vectors.h5.", Partial::Kind::file);
    Partial const figures(in_folder("case"), ".comparison.", Partial::Kind::folder);
    _exit(0);
  }
  waitpid(child, nullptr, 0);
  write_case("new");
  EXPECT_THAT(names("case"), ElementsAre("flow.tif", "maps", "notes.txt", "setup.toml"));
}

// If the marker exists, all files are of one version; otherwise the next access completes the new version.
TEST_F(OutputFolderTest, KilledAtAnyStepItIsTheOldCaseOrTheNewOne) {
  bool ended = false;
  int step = 0, completed = 0;
  for (; !ended; ++step) {
    ASSERT_LT(step, 100);
    write_old_case();
    ended = replace_and_die(step);
    if (has("setup.toml")) {
      EXPECT_TRUE(is_of("old") || is_of("new")) << step;
    }
    bool const begun = has(".replacing");
    EXPECT_TRUE(is_complete(in_folder("case"), content_of_case)) << step;
    EXPECT_TRUE(is_of(begun || ended ? "new" : "old")) << step;
    EXPECT_EQ(has("vectors.h5"), is_of("old")) << step;
    EXPECT_EQ(read("notes.txt"), "mine") << step;
    completed += begun;
    write_case("newer");
    EXPECT_TRUE(is_of("newer")) << step;
    EXPECT_THAT(names("case"), ElementsAre("flow.tif", "maps", "notes.txt", "setup.toml")) << step;
    EXPECT_THAT(names(), ElementsAre("case"));
  }
  EXPECT_GE(completed, 8)
      << "the process was killed before each of eight renames: four files retired, three installed, one directory";
}

TEST_F(OutputFolderTest, RepeatedlyKilledReplacementIsCompleted) {
  for (int step = 0; step < 4; ++step) {
    write_old_case();
    ASSERT_FALSE(replace_and_die(3));
    ASSERT_TRUE(has(".replacing"));
    EXPECT_FALSE(replace_and_die(step));
    EXPECT_TRUE(is_complete(in_folder("case"), content_of_case));
    EXPECT_TRUE(is_of("new")) << step;
    EXPECT_FALSE(has("vectors.h5")) << step;
  }
}

TEST_F(OutputFolderTest, FailedMoveRestoresAllFiles) {
  for (int step = 0;; ++step) {
    ASSERT_LT(step, 100);
    write_old_case();
    renames_until_failure = step;
    std::string const error = error_of([&] { write_case("new"); });
    bool const failed = renames_until_failure < 0;
    renames_until_failure = -1;
    if (!failed) break;
    if (error.empty()) {
      EXPECT_TRUE(is_of("new")) << "only the cleanup failed";
    } else {
      EXPECT_EQ(error, "output at case");
      EXPECT_TRUE(is_of("old")) << step;
      EXPECT_TRUE(has("vectors.h5")) << step;
    }
    EXPECT_FALSE(has(".replacing")) << step;
  }
}

// Derived files are removed, by name or pattern, in every subdirectory that receives new files; elsewhere they are
// retained, as are all other files.
TEST_F(OutputFolderTest, RemovesDerivedFilesInFoldersThatReceiveNewFiles) {
  FolderContent const content{"setup.toml", {"vectors.h5", "plane_*.tif"}};
  auto const write_cameras = [&](std::vector<std::string> const& cameras) {
    OutputFolder folder(in_folder("case"), content);
    std::ofstream(folder.temporary_path() + "/setup.toml") << "all";
    for (std::string const& camera : cameras) {
      fs::create_directory(folder.temporary_path() + "/" + camera);
      std::ofstream(folder.temporary_path() + "/" + camera + "/plane_000.tif") << "new";
    }
    folder.commit();
  };
  write_cameras({"left", "right"});
  for (std::string const camera : {"left", "right"}) {
    for (std::string const name : {"vectors.h5", "plane_001.tif", "plane_.png", "notes.txt"}) {
      write("case/" + camera + "/" + name, "old");
    }
  }
  write_cameras({"left"});
  EXPECT_THAT(names("case/left"), ElementsAre("notes.txt", "plane_.png", "plane_000.tif"));
  EXPECT_THAT(names("case/right"),
              ElementsAre("notes.txt", "plane_.png", "plane_000.tif", "plane_001.tif", "vectors.h5"));
}

TEST_F(OutputFolderTest, AReplacementThatWasBrokenOffIsCompletedForItsParts) {
  write_old_case();
  ASSERT_FALSE(replace_and_die(3));
  ASSERT_TRUE(has(".replacing"));
  complete_parent_replacement(in_folder("case/elsewhere"), content_of_case);
  EXPECT_TRUE(has(".replacing"));
  complete_parent_replacement(in_folder("case/maps/"), content_of_case);
  EXPECT_FALSE(has(".replacing"));
  EXPECT_TRUE(is_of("new"));
}

TEST_F(OutputFolderTest, AReplacementByAWriterThatCannotBeAskedIsRefusedByName) {
  write_old_case();
  fs::create_directories(folder_ / "case/.replacing/new");
  write("case/.replacing/lock-elsewhere-0123456789abcdef-1-17-1", "");
  write("case/.replacing/new/flow.tif", "new");
  fs::remove(folder_ / "case/setup.toml");
  EXPECT_THAT([&] { is_complete(in_folder("case"), content_of_case); }, ThrowsOutputError("case"));
  EXPECT_TRUE(has(".replacing/new/flow.tif"));
}

}  // namespace
}  // namespace gladstone
