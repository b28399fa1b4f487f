#include "render/files/partial.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>

#include "render/base/error.h"
#include "tests/files/support/output.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::IsEmpty;

/// Parts of ".a.partial-HOST-BOOT-DISK-PROCESS-RANDOM".
enum Part { host, boot, disk, process };

class PartialTest : public Output {
 protected:
  /// Another process that creates a partial output and waits until it is killed by SIGKILL, without any cleanup.
  class Writer {
   public:
    Writer(fs::path const& folder, Partial::Kind kind) {
      EXPECT_EQ(pipe(ready_.data()), 0);
      child_ = fork();
      if (child_ == 0) {
        Partial const partial(folder.string(), ".a.", kind);
        if (::write(ready_[1], "x", 1) == 1) pause();
        _exit(1);
      }
      char x = 0;
      EXPECT_EQ(::read(ready_[0], &x, 1), 1);
    }
    ~Writer() { kill(); }
    Writer(Writer const&) = delete;
    Writer& operator=(Writer const&) = delete;
    void kill() {
      if (child_ <= 0) return;
      ::kill(child_, SIGKILL);
      waitpid(child_, nullptr, 0);
      child_ = 0;
    }

   private:
    std::array<int, 2> ready_{};
    pid_t child_ = 0;
  };

  /// Returns the partial output of a killed writer.
  fs::path leftover(Partial::Kind kind) {
    Writer(folder_, kind).kill();
    return folder_ / names().front();
  }

  /// Renames a partial output and its lock file so that one part of the name has another value.
  static fs::path renamed(fs::path const& partial, Part part, std::string const& value) {
    auto const changed = [&](std::string name) {
      std::size_t begin = name.find('-') + 1;
      for (int i = 0; i < part; ++i) begin = name.find('-', begin) + 1;
      return name.replace(begin, name.find('-', begin) - begin, value);
    };
    if (fs::is_directory(partial)) {
      for (auto const& lock : fs::directory_iterator(partial)) {
        fs::rename(lock.path(), partial / changed(lock.path().filename().string()));
        break;
      }
    }
    fs::path const fresh = partial.parent_path() / changed(partial.filename().string());
    fs::rename(partial, fresh);
    return fresh;
  }
  /// Sets the time of the last change to before the start of this system, which was after 1980.
  static void make_old(fs::path const& partial) {
    auto const long_ago = fs::file_time_type::clock::now() - std::chrono::hours(24 * 365 * 40);
    if (fs::is_directory(partial)) {
      for (auto const& entry : fs::directory_iterator(partial)) fs::last_write_time(entry.path(), long_ago);
    }
    fs::last_write_time(partial, long_ago);
  }
  bool is_cleared_away(fs::path const& partial) const {
    remove_abandoned_outputs(folder_.string(), ".a.");
    return !fs::exists(partial);
  }
};

TEST_F(PartialTest, ExistsWhileWriterIsRunning) {
  for (auto const kind : {Partial::Kind::file, Partial::Kind::folder}) {
    Writer writer(folder_, kind);
    fs::path partial = folder_ / names().front();
    EXPECT_FALSE(is_cleared_away(partial));
    // in another process namespace, the number of a process may be unused here or belong to another process
    partial = renamed(partial, process, "1999999999");
    EXPECT_FALSE(is_cleared_away(partial));
    partial = renamed(partial, process, std::to_string(getpid()));
    EXPECT_FALSE(is_cleared_away(partial));
    writer.kill();
    EXPECT_TRUE(is_cleared_away(partial));
    EXPECT_THAT(names(), IsEmpty());
  }
}

TEST_F(PartialTest, OwnOutputIsRemovedOnDestruction) {
  for (auto const kind : {Partial::Kind::file, Partial::Kind::folder}) {
    Partial const one(folder_.string(), ".a.", kind), other(folder_.string(), ".a.", kind);
    EXPECT_NE(one.path(), other.path());
    EXPECT_FALSE(is_cleared_away(one.path()));
    EXPECT_FALSE(is_cleared_away(other.path()));
  }
  EXPECT_THAT(names(), IsEmpty());
}

TEST_F(PartialTest, OfAnotherHostIsLeftAlone) {
  for (auto const kind : {Partial::Kind::file, Partial::Kind::folder}) {
    fs::path partial = renamed(renamed(leftover(kind), host, "elsewhere"), boot, "0123456789abcdef");
    EXPECT_FALSE(is_cleared_away(partial));
    make_old(partial);
    EXPECT_FALSE(is_cleared_away(partial));
    fs::remove_all(partial);
  }
}

TEST_F(PartialTest, OfAnEarlierBootOfThisHostIsClearedAwayUnlessItIsYounger) {
  for (auto const kind : {Partial::Kind::file, Partial::Kind::folder}) {
    fs::path const partial = renamed(leftover(kind), boot, "0123456789abcdef");
    EXPECT_FALSE(is_cleared_away(partial)) << "may belong to another machine of the same name";
    make_old(partial);
    EXPECT_TRUE(is_cleared_away(partial));
  }
}

// Locks made through another mount of the same network disk may be invisible here.
TEST_F(PartialTest, FileOnOtherMountIsPreserved) {
  fs::path const partial = renamed(leftover(Partial::Kind::folder), disk, "fffffff0");
  EXPECT_FALSE(is_cleared_away(partial));
}

TEST_F(PartialTest, WithoutLocksOrOfAnotherVersionIsLeftAlone) {
  fs::path const unlocked = renamed(leftover(Partial::Kind::file), boot, "unlocked");
  make_old(unlocked);
  EXPECT_FALSE(is_cleared_away(unlocked));
  for (std::string const name : {".a.partial-4711", ".a.partial-mine", ".a.partial-"}) {
    write(name, "half");
    EXPECT_FALSE(is_cleared_away(in_folder(name)));
  }
}

TEST_F(PartialTest, OfAnotherNameIsLeftAlone) {
  fs::path const partial = leftover(Partial::Kind::file);
  remove_abandoned_outputs(folder_.string(), ".b.");
  EXPECT_TRUE(fs::exists(partial));
}

TEST_F(PartialTest, DescribesWriter) {
  Partial const partial(folder_.string(), ".a.", Partial::Kind::folder);
  EXPECT_THAT(describe_writer(partial.path()), testing::HasSubstr("process " + std::to_string(getpid()) + " on host "));
}

TEST_F(PartialTest, ErrorsNameTheFinalPlace) {
  EXPECT_THAT([] { report_final_path("/a/.b", "case", [] { throw OutputError("/a/.b/flow.tif", "is full"); }); },
              ThrowsOutputError("case/flow.tif"));
  EXPECT_THAT([] { report_final_path("/a/.b", "case", [] { throw OutputError("/tmp/x", "is full"); }); },
              ThrowsOutputError("/tmp/x"));
}

}  // namespace
}  // namespace gladstone
