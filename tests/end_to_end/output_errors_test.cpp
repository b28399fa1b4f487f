#include <sched.h>
#include <sys/mount.h>
#include <sys/resource.h>

#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using namespace std::chrono_literals;

/// Unwritable outputs and interrupted runs: the old output remains, and nothing else.
class OutputErrors : public ProgramFixture {
 protected:
  /// A rendering that would take minutes, interrupted when it begins to trace.
  Outcome interrupt_a_rendering(int signal) const {
    Program program(
        {"render", "setup.toml", "-o", "case", "--set", "render.rays_per_dot=1000000", "--set", "render.method=rays"},
        folder_, stopping_at("rendering"));
    EXPECT_TRUE(program.wait_until_stopped());
    EXPECT_TRUE(is_rendering());
    program.send(signal);
    program.send(SIGCONT);
    return program.finish(hang_limit);
  }
  bool is_rendering() const {
    auto all = names();
    if (std::filesystem::exists(in("case"))) {
      for (std::string const& name : names("case")) all.push_back(name);
    }
    return std::any_of(all.begin(), all.end(), [](std::string const& name) {
      return name.starts_with(".case.partial-") || name.starts_with(".partial-");
    });
  }
};

TEST_F(OutputErrors, AFileInThePath) {
  expect_error({"render", "setup.toml", "-o", "setup.toml/case"}, 2, "output at case");
  expect_error({"render", "setup.toml", "-o", "setup.toml"}, 2, "output at setup.toml");
}

TEST_F(OutputErrors, APlaceWhereNothingCanBeMade) {
  expect_error({"render", "setup.toml", "-o", "/proc/nowhere/case"}, 2, "output at nowhere");
}

TEST_F(OutputErrors, UnrelatedFolderIsPreserved) {
  std::filesystem::create_directory(in("thesis"));
  write("thesis/chapter1.tex", "precious");
  expect_error({"render", "setup.toml", "-o", "thesis"}, 2, "output at thesis");
}

TEST_F(OutputErrors, ReadOnlyFolder) {
  std::filesystem::create_directory(in("locked"));
  std::filesystem::permissions(in("locked"), std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec |
                                                 std::filesystem::perms::others_read |
                                                 std::filesystem::perms::others_exec);
  auto const without_privileges = [] { return ::geteuid() != 0 || (::setgid(65534) == 0 && ::setuid(65534) == 0); };
  Outcome const outcome = run({"render", "setup.toml", "-o", "locked/case", "--json"}, folder_, without_privileges);
  if (outcome.exit_code == 126) GTEST_SKIP() << "the program cannot be run without root's rights from here";
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
  expect_error_in(outcome, "output at case", {"Permission denied"});
  EXPECT_TRUE(names("locked").empty());
}

TEST_F(OutputErrors, FullDiskLeavesTheOldCase) {
  // a disk of 64 kB in a separate mount namespace: truth.h5 and two images are larger
  pid_t const child = ::fork();
  if (child == 0) {
    std::filesystem::create_directory(in("disk"));
    bool const mounted = ::unshare(CLONE_NEWNS) == 0 &&
                         ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                         ::mount("none", in("disk").c_str(), "tmpfs", 0, "size=64k") == 0;
    if (!mounted) ::_exit(77);
    std::filesystem::create_directory(in("disk/case"));
    write("disk/case/setup.toml", "old");
    Outcome const outcome = run({"render", "setup.toml", "-o", "disk/case"}, folder_);
    write("stderr", outcome.err);
    bool const as_before = names("disk") == std::vector<std::string>{"case"} &&
                           names("disk/case") == std::vector<std::string>{"setup.toml"} &&
                           read("disk/case/setup.toml") == "old";
    ::_exit(outcome.exit_code == 2 ? (as_before ? 0 : 1) : 2);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  ASSERT_TRUE(WIFEXITED(status));
  if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "no mount namespace here; see FilesThatMayNotGrow";
  EXPECT_EQ(WEXITSTATUS(status), 0) << read("stderr");
  EXPECT_THAT(read("stderr"),
              testing::AllOf(testing::HasSubstr("gladstone: disk/case/"), testing::HasSubstr("No space left on device"),
                             testing::Not(testing::HasSubstr("partial"))));
}

TEST_F(OutputErrors, FullDiskWhileDrawingLeavesTheOldResults) {
  // space for errors.json, a few kB, but not for the figures, tens of kB each: both on the case's disk and on that of
  // gnuplot's temporary files
  for (bool const temporary : {false, true}) {
    std::filesystem::remove_all(in("case"));
    render("case");
    succeed({"correlate", "case"});
    write("case/errors.json", "old");
    write("case/error_budget.png", "old");
    pid_t const child = ::fork();
    if (child == 0) {
      std::string const disk = temporary ? "disk" : "case";
      std::error_code error;
      std::filesystem::create_directory(in("disk"), error);
      std::filesystem::rename(in("case"), in("aside"), error);
      std::filesystem::create_directory(in("case"), error);
      bool const mounted = ::unshare(CLONE_NEWNS) == 0 &&
                           ::mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
                           ::mount("none", in(disk).c_str(), "tmpfs", 0, temporary ? "size=8k" : "size=400k") == 0;
      if (mounted) std::filesystem::copy(in("aside"), in("case"), std::filesystem::copy_options::recursive, error);
      if (mounted && !temporary) {  // leave 40 kB
        write("case/filler", std::string(std::filesystem::space(in("case"), error).available - 40000, 'x'));
      }
      if (mounted && temporary) ::setenv("TMPDIR", in(disk).c_str(), 1);
      Outcome const outcome = mounted ? run({"compare", "case"}, folder_) : Outcome{};
      std::filesystem::remove(in("case/filler"));
      bool as_before = mounted && names("case") == names("aside");
      for (auto const& name : mounted ? names("case") : std::vector<std::string>{}) {
        as_before = as_before && read("case/" + name) == read("aside/" + name);
      }
      write("stderr", outcome.err);
      ::_exit(!mounted ? 77 : outcome.exit_code == 2 ? (as_before ? 0 : 1) : 2);
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    ASSERT_TRUE(WIFEXITED(status));
    std::filesystem::remove_all(in("case"));
    std::filesystem::remove_all(in("aside"));
    if (WEXITSTATUS(status) == 77) GTEST_SKIP() << "no mount namespace here";
    EXPECT_EQ(WEXITSTATUS(status), 0) << read("stderr");
    EXPECT_THAT(read("stderr"), testing::HasSubstr("No space left on device")) << temporary;
  }
}

TEST_F(OutputErrors, FilesThatMayNotGrow) {
  render("case");
  auto const before = everything();
  auto const limited = [] {
    rlimit const limit{4096, 4096};
    return ::setrlimit(RLIMIT_FSIZE, &limit) == 0;
  };
  Outcome const outcome =
      run({"render", "setup.toml", "-o", "case", "--set", "render.seed=2", "--json"}, folder_, limited);
  EXPECT_EQ(outcome.exit_code, 2) << outcome.err << outcome.signal;
  auto const error = nlohmann::json::parse(outcome.out)["errors"][0];
  EXPECT_EQ(error["code"], "output");
  EXPECT_THAT(error["place"].get<std::string>(), testing::StartsWith("case/")) << "the name as given";
  EXPECT_THAT(outcome.err, testing::Not(testing::HasSubstr("partial")));
  EXPECT_TRUE(everything() == before) << testing::PrintToString(names());
}

TEST_F(OutputErrors, InterruptedRenderLeavesNoFiles) {
  for (int const signal : {SIGINT, SIGTERM}) {
    Outcome const outcome = interrupt_a_rendering(signal);
    EXPECT_EQ(outcome.exit_code, 130) << outcome.err << outcome.signal;
    EXPECT_EQ(names(), std::vector<std::string>{"setup.toml"});
  }
}

TEST_F(OutputErrors, ControlCLeavesTheOldCaseAsItWas) {
  render("case");
  succeed({"correlate", "case"});
  auto const before = everything();
  EXPECT_EQ(interrupt_a_rendering(SIGINT).exit_code, 130);
  EXPECT_TRUE(everything() == before) << testing::PrintToString(names());
}

TEST_F(OutputErrors, NextRunRemovesAbandonedFiles) {
  interrupt_a_rendering(SIGKILL);
  EXPECT_TRUE(is_rendering());
  render("case");
  EXPECT_FALSE(is_rendering());
}

// At every step of a replacement a killed run leaves the old files, or new ones that the next command completes.
TEST_F(OutputErrors, AReplacementThatIsKilledAtAnyStepLeavesOneWholeCase) {
  render("old");
  render("new", {"--set", "target.seed=8"});
  for (std::string const point : {"rendering", "file-written", "file-written:4", "replacement-begun",
                                  "replacement-retired", "replacement-installed"}) {
    std::filesystem::remove_all(in("case"));
    render("case");
    Program program({"render", "setup.toml", "-o", "case", "--set", "target.seed=8"}, folder_, stopping_at(point));
    ASSERT_TRUE(program.wait_until_stopped()) << point;
    program.send(SIGKILL);
    EXPECT_EQ(program.finish(hang_limit).signal, SIGKILL);
    succeed({"correlate", "case"});  // completes the replacement
    expect_same_case(point.starts_with("replacement") ? "new" : "old", "case");
    EXPECT_FALSE(std::filesystem::exists(in("case/.replacing"))) << point;
    succeed({"compare", "case", "--no-figures"});
  }
}

TEST_F(OutputErrors, RenderingAgainKeepsWhatTheUserAddedAndDropsWhatWasMeasured) {
  render("case");
  succeed({"correlate", "case"});
  std::filesystem::create_directory(in("case/plots"));
  write("case/notes.txt", "mine");
  write("case/plots/a.dat", "mine too");
  render("case", {"--set", "target.seed=8"});
  EXPECT_EQ(read("case/notes.txt"), "mine");
  EXPECT_EQ(read("case/plots/a.dat"), "mine too");
  EXPECT_FALSE(std::filesystem::exists(in("case/vectors.h5")));
}

}  // namespace
}  // namespace gladstone::end_to_end
