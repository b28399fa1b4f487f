#include "studies/drawing/temporary_directory.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

namespace gladstone {
namespace {

namespace fs = std::filesystem;

/// Creates temporary directories in a separate TMPDIR, so that the test can count them.
class TemporaryDirectories : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(place_);
    fs::create_directories(place_);
    ::setenv("TMPDIR", place_.c_str(), 1);
  }
  void TearDown() override {
    ::unsetenv("TMPDIR");
    fs::remove_all(place_);
  }
  std::ptrdiff_t count() const { return std::distance(fs::directory_iterator(place_), {}); }

  fs::path const place_ = fs::path(testing::TempDir()) / "temporary_directories";
};

TEST_F(TemporaryDirectories, IsPrivateAndRemovedOnDestruction) {
  {
    TemporaryDirectory const one, other;
    EXPECT_NE(one.path(), other.path());
    EXPECT_TRUE(fs::is_empty(one.path()));
    EXPECT_EQ(fs::status(one.path()).permissions(), fs::perms::owner_all);
    std::ofstream(one.path() + "/file") << "text";
    EXPECT_EQ(count(), 2);
  }
  EXPECT_EQ(count(), 0);
}

// The killed process cannot remove anything; the folder of a running one remains.
TEST_F(TemporaryDirectories, AbandonedOnesAreRemoved) {
  int ready[2];
  ASSERT_EQ(::pipe(ready), 0);
  pid_t const child = ::fork();
  if (child == 0) {
    TemporaryDirectory const left;
    std::ofstream(left.path() + "/file") << "text";
    if (::write(ready[1], "x", 1) == 1) ::pause();
    ::_exit(1);
  }
  char x = 0;
  ASSERT_EQ(::read(ready[0], &x, 1), 1);
  {
    TemporaryDirectory const next;
    EXPECT_EQ(count(), 2) << "its process is still running";
  }
  ::kill(child, SIGKILL);
  ::waitpid(child, nullptr, 0);
  EXPECT_EQ(count(), 1);
  TemporaryDirectory const next;
  EXPECT_EQ(count(), 1);
  EXPECT_TRUE(fs::is_directory(next.path()));
}

}  // namespace
}  // namespace gladstone
