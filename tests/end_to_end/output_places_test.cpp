#include <sched.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/stat.h>

#include "render/files/partial.h"
#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;
namespace fs = std::filesystem;

/// Permitted places of results; other writers and inputs are not affected.
class Places : public ProgramFixture {
 protected:
  /// A rendering, and the disturbance when it begins to trace.
  Outcome signalled_rendering(int signal, std::function<bool()> const& prepare = {}) const {
    Program program({"render", "setup.toml", "-o", "case"}, folder_, stopping_at("rendering", prepare));
    EXPECT_TRUE(program.wait_until_stopped());
    EXPECT_EQ(partials().size(), 1u);
    program.send(signal);
    program.send(SIGCONT);
    return program.finish(hang_limit);
  }
  std::vector<std::string> partials() const {
    std::vector<std::string> all = names();
    std::erase_if(all, [](std::string const& name) { return !name.starts_with(".case.partial-"); });
    return all;
  }
};

/// Runs the rest of the child in a separate process namespace with another host name, as in a container. The first
/// process of the namespace cannot be stopped by itself; it waits for the program, the second one.
/// @param stopped  pipe to which a byte is written when the program has stopped itself
bool enter_container(int stopped) {
  if (::unshare(CLONE_NEWPID | CLONE_NEWUTS) != 0 || ::sethostname("container", 9) != 0) return false;
  for (bool const first : {true, false}) {
    pid_t const child = ::fork();
    if (child < 0) return false;
    if (child == 0) {
      if (::prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) return false;
      continue;
    }
    int status = 0;
    while (::waitpid(child, &status, first ? 0 : WUNTRACED) == child && WIFSTOPPED(status)) {
      char const byte = 1;
      if (::write(stopped, &byte, 1) != 1) ::_exit(125);
    }
    ::_exit(WIFEXITED(status) ? WEXITSTATUS(status) : 125);
  }
  return true;
}

TEST_F(Places, ALiveRunOfAnotherContainerIsLeftAloneAndADeadOneClearedAway) {
  int alive[2];  // open for writing in every process of the container
  ASSERT_EQ(::pipe(alive), 0);
  Program inside({"render", "setup.toml", "-o", "case"}, folder_,
                 stopping_at("rendering", [&alive] { return enter_container(alive[1]); }));
  ::close(alive[1]);
  auto const read_byte = [&alive] {
    char byte = 0;
    ssize_t count = -1;
    while ((count = ::read(alive[0], &byte, 1)) < 0 && errno == EINTR) {
    }
    return count == 1;
  };
  if (!read_byte()) {
    Outcome const outcome = inside.finish(hang_limit);
    ASSERT_EQ(outcome.exit_code, 126) << outcome.err;
    GTEST_SKIP() << "a process namespace needs root's rights, which this user does not have";
  }
  auto const theirs = partials();
  ASSERT_EQ(theirs.size(), 1u);
  EXPECT_THAT(theirs[0], HasSubstr("-container-"));
  render("case");
  EXPECT_EQ(partials(), theirs) << "it is still running";
  inside.finish(0s);     // and with it the container
  while (read_byte()) {  // ends when all its processes have ended
  }
  ::close(alive[0]);
  fs::remove_all(in("case"));
  render("case");
  EXPECT_TRUE(partials().empty());
}

// An existing folder is neither moved nor replaced.
TEST_F(Places, TheWorkingDirectoryOfAShellIsKept) {
  fs::create_directory(in("here"));
  struct stat before {};
  struct stat after {};
  ASSERT_EQ(::stat(in("here").c_str(), &before), 0);
  for (int round = 0; round < 2; ++round) {
    Outcome const outcome = run({"render", "../setup.toml", "-o", "."}, in("here"));
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    EXPECT_EQ(names("here").size(), 5u) << testing::PrintToString(names("here"));
  }
  EXPECT_EQ(run({"correlate", "."}, in("here")).exit_code, 0);
  EXPECT_EQ(run({"compare", ".", "--no-figures"}, in("here")).exit_code, 0);
  ASSERT_EQ(::stat(in("here").c_str(), &after), 0);
  EXPECT_EQ(before.st_ino, after.st_ino);
  EXPECT_EQ(before.st_mode, after.st_mode);
}

TEST_F(Places, AMountPoint) {
  fs::create_directory(in("disk"));
  pid_t const child = ::fork();
  if (child == 0) {
    bool const mounted = ::unshare(CLONE_NEWNS) == 0 &&
                         ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                         ::mount("none", in("disk").c_str(), "tmpfs", 0, "size=8m") == 0;
    if (!mounted) ::_exit(77);
    std::string err;
    for (auto const& command : std::vector<std::vector<std::string>>{{"render", "setup.toml", "-o", "disk"},
                                                                     {"render", "setup.toml", "-o", "disk"},
                                                                     {"correlate", "disk"},
                                                                     {"compare", "disk", "--no-figures"}}) {
      Outcome const outcome = run(command, folder_);
      if (outcome.exit_code != 0) err += outcome.err;
    }
    write("file.csv", "old");
    if (::mount(in("setup.toml").c_str(), in("file.csv").c_str(), nullptr, MS_BIND, nullptr) != 0) ::_exit(77);
    Outcome const onto = run({"correlate", "disk", "-o", "file.csv"}, folder_);
    if (onto.exit_code != 2 || onto.err.find("gladstone: file.csv: ") == std::string::npos) err += onto.err + '?';
    write("stderr", err);
    ::_exit(err.empty() ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "no mount namespace here; see TheFolderThatAShellStandsIn";
  EXPECT_EQ(WEXITSTATUS(status), 0) << read("stderr");
}

// State after a rendering that was killed after the first of its moves.
TEST_F(Places, ACommandThatReadsACaseCompletesAnInterruptedReplacement) {
  render("case");
  render("fresh", {"--set", "target.seed=8"});
  pid_t const child = ::fork();
  if (child == 0) {
    Partial partial(in("case"), ".", Partial::Kind::folder);
    fs::path const work = in("case/.replacing");
    fs::copy(in("fresh"), fs::path(partial.path()) / "new");
    fs::create_directory(fs::path(partial.path()) / "old");
    if (partial.move_to(work) != 0) ::_exit(1);
    fs::rename(in("case/setup.toml"), work / "old/setup.toml");
    ::_exit(0);
  }
  ::waitpid(child, nullptr, 0);
  succeed({"correlate", "case"});
  expect_same_case("case", "fresh");
  EXPECT_EQ(names("case").size(), 6u) << testing::PrintToString(names("case"));
  EXPECT_EQ(read("case/setup.toml"), read("fresh/setup.toml"));
}

TEST_F(Places, DevicesAndOpenFilesAreRefusedBeforeAnythingIsComputed) {
  render("case");
  write("rays.csv", "x_mm,y_mm,z_mm,dx,dy,dz\n0,0,-250,0,0,1\n");
  for (std::string const place : {"/dev/full", "/dev/null"}) {
    expect_error({"render", "setup.toml", "-o", place}, 2, "output at " + place.substr(5));
    expect_error({"trace", "setup.toml", "--rays", "rays.csv", "-o", place}, 2, "output at " + place.substr(5));
    expect_error({"demo", "-o", place}, 2, "output at summary.md", {});
  }
  expect_error({"trace", "setup.toml", "--rays", "rays.csv", "-o", "/dev/stdout"}, 2, "output at stdout");
  expect_error({"correlate", "case", "-o", "/dev/full"}, 2, "output at full");
}

TEST_F(Places, AnOutputIsNeverAnInput) {
  write("rays.csv", "x_mm,y_mm,z_mm,dx,dy,dz\n0,0,-250,0,0,1\n");
  fs::create_symlink("rays.csv", in("link.csv"));
  fs::create_hard_link(in("rays.csv"), in("hard.csv"));
  std::string const around = "../" + folder_.filename().string() + "/rays.csv";
  for (std::string const& output : std::vector<std::string>{"rays.csv", "link.csv", "hard.csv", around}) {
    expect_error({"trace", "setup.toml", "--rays", "rays.csv", "-o", output}, 2,
                 "overwrites_input at " + fs::path(output).filename().string());
  }
  expect_error({"trace", "setup.toml", "--rays", "rays.csv", "-o", "setup.toml"}, 2, "overwrites_input at setup.toml");
  expect_error({"render", "setup.toml", "-o", "."}, 2, "overwrites_input at setup.toml");
  render("case");
  expect_error({"render", "case/setup.toml", "-o", "case"}, 2, "overwrites_input at setup.toml");
  fs::create_symlink("case/truth.h5", in("v.h5"));
  expect_error({"correlate", "case", "-o", "v.h5"}, 2, "overwrites_input at v.h5");
  fs::copy(in("case/reference.tif"), in("picture.csv"));
  expect_error({"correlate", "picture.csv", "case/flow.tif", "-o", "picture.csv"}, 2,
               "overwrites_input at picture.csv");
  succeed({"correlate", "case"});
  fs::create_symlink("vectors.h5", in("case/errors.json"));
  expect_error({"compare", "case"}, 2, "overwrites_input at errors.json");
  fs::create_directory(in("run"));
  write("run/study.toml", "base = \"../setup.toml\"\n[axes]\n\"lens.f_number\" = [8]\n");
  fs::create_directory(in("run/cases"));
  expect_error({"sweep", "plan", "run/study.toml", "-o", "run", "--device", "cpu"}, 2,
               "overwrites_input at study.toml");
}

// A field in the place of one of the case's own files: it would be read, and then overwritten.
TEST_F(Places, AFileThatTheSetupNamesIsNoOutput) {
  write("dots.csv", "x_mm,y_mm\n0,0\n1,0.5\n-1,0.25\n");
  write("points.toml", with(small_setup, "dots_per_32px_window = 10.0", "kind = \"points\"\nfile = \"dots.csv\""));
  render("case", {}, "points.toml");
  fs::rename(in("dots.csv"), in("case/vectors.csv"));
  fs::create_symlink("case/vectors.csv", in("dots.csv"));
  expect_error({"render", "points.toml", "-o", "case"}, 2, "overwrites_input at vectors.csv");
}

TEST_F(Places, AHangUpCleansUpUnlessItIsIgnored) {
  Outcome const outcome = signalled_rendering(SIGHUP);
  EXPECT_EQ(outcome.exit_code, 130) << outcome.err << outcome.signal;
  EXPECT_EQ(names(), std::vector<std::string>{"setup.toml"});
  Outcome const detached = signalled_rendering(SIGHUP, [] { return ::signal(SIGHUP, SIG_IGN) != SIG_ERR; });
  EXPECT_EQ(detached.exit_code, 0) << "under nohup it continues: " << detached.err;
  EXPECT_EQ(names(), (std::vector<std::string>{"case", "setup.toml"}));
}

TEST_F(Places, AStudyIsRefusedItsPlaceBeforeItIsPlanned) {
  fs::create_directory(in("thesis"));
  write("thesis/chapter1.tex", "precious");
  write("study.toml", "base = \"setup.toml\"\n[axes]\n\"lens.f_number\" = [8]\n");
  expect_error({"sweep", "plan", "study.toml", "-o", "thesis", "--device", "cpu"}, 2, "output at thesis");
}

}  // namespace
}  // namespace gladstone::end_to_end
