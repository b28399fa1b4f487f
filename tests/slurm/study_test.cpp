#include <csignal>
#include <functional>

#include "render/files/hdf5_file.h"
#include "studies/sweep/case_locks.h"
#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::HasSubstr;
using namespace std::chrono_literals;

/// Returns the output of a command line.
std::string output_of(std::string const& command) {
  std::string text;
  std::FILE* const pipe = ::popen(command.c_str(), "r");
  for (int c; (c = std::fgetc(pipe)) != EOF;) text += static_cast<char>(c);
  ::pclose(pipe);
  return text;
}

bool comes_true(std::function<bool()> const& condition, std::chrono::seconds limit = 60s) {
  for (auto const end = std::chrono::steady_clock::now() + limit; !condition(); std::this_thread::sleep_for(20ms)) {
    if (std::chrono::steady_clock::now() > end) return false;
  }
  return true;
}

/// A study of six cases, planned twice: "local" is run here, "cluster" by a Slurm cluster's array. The test claims some
/// cases, so that the tasks that are to compute them wait and can be disturbed while they run.
class StudyOnACluster : public ProgramFixture {
 protected:
  void SetUp() override {
    ProgramFixture::SetUp();
    write("study.toml",
          "base = \"setup.toml\"\n[axes]\n\"lens.f_number\" = [8, 11, 16]\n\"geometry.z_d_mm\" = [200, 250]\n");
    for (std::string const run : {"local", "cluster"})
      succeed({"sweep", "plan", "study.toml", "-o", run, "--device", "cpu", "--quiet"});
    succeed({"sweep", "run", "local", "--quiet"});
    collect("local");
  }
  void TearDown() override {
    output_of("scancel --user=$(id -u)");
    EXPECT_TRUE(comes_true([] { return output_of("squeue --noheader").empty(); }));
    ProgramFixture::TearDown();
  }

  void collect(std::string const& run) const { succeed({"sweep", "collect", run, "--no-figures", "--quiet"}); }

  /// Equal study.h5, but for how long it took.
  void expect_same_study() const {
    collect("cluster");
    Hdf5Reader const local(in("local/study.h5").string()), cluster(in("cluster/study.h5").string());
    auto const names = local.dataset_names();
    EXPECT_EQ(names, cluster.dataset_names());
    std::size_t compared = 0;
    for (auto const& name : names) {
      if (name.find("seconds") != std::string::npos) continue;
      auto const x = local.read(name), y = cluster.read(name);
      ASSERT_EQ(x.size(), y.size()) << name;
      EXPECT_EQ(std::memcmp(x.data(), y.data(), x.size() * sizeof(double)), 0) << name;
      ++compared;
    }
    EXPECT_GT(compared, 10u);  // axes and measures
  }

  static std::vector<std::string> submit(std::vector<std::string> const& more = {}) {
    std::vector<std::string> arguments{"sweep", "run", "cluster", "--slurm", "--cases-per-task", "2"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return arguments;
  }
  /// The array's number, once it is submitted.
  std::string job() const {
    EXPECT_TRUE(comes_true([this] { return std::filesystem::exists(in("cluster/slurm/job")); }));
    std::string const text = read("cluster/slurm/job");
    return text.substr(0, text.find('\n'));
  }
  /// Process of the task that computes these cases; 0 where none runs.
  int process_of(std::string const& cases) const {
    std::string const arguments = in("cluster").string() + '\0' + "--case" + '\0' + cases + '\0';
    for (auto const& entry : std::filesystem::directory_iterator("/proc")) {
      std::string const name = entry.path().filename().string();
      if (name.find_first_not_of("0123456789") != std::string::npos) continue;
      if (content(entry.path() / "cmdline").find(arguments) != std::string::npos) return std::stoi(name);
    }
    return 0;
  }
};

TEST_F(StudyOnACluster, AnArrayGivesWhatALocalRunGives) {
  Outcome const outcome = gladstone(submit({"--throttle", "2", "--partition", "all", "--time", "1"}));
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("6 done"));
  EXPECT_THAT(read("cluster/slurm/job.sh"), HasSubstr("\n0-1\n2-3\n4-5\nEND\n"));
  expect_same_study();
}

// Two of three tasks are killed while they run: one by the user's scancel, and one by kill -9, as if memory were
// insufficient. The study is then reported as incomplete; when it is submitted again, only the missing cases are
// computed.
TEST_F(StudyOnACluster, KilledTasksAreMadeUpForByTheNextSubmission) {
  {
    CaseLocks claims(in("cluster").string(), CaseLocks::Use::take);
    ASSERT_TRUE(claims.take(1) && claims.take(3));
    Program program(submit(), folder_);
    std::string const id = job();
    for (std::string const first : {"0", "2"})  // then both tasks wait for the case that the test has
      ASSERT_TRUE(comes_true([&] { return std::filesystem::exists(in("cluster/cases/" + first + ".json")); }));
    ::kill(process_of("0-1"), SIGKILL);
    output_of("scancel " + id + "_1");
    Outcome const outcome = program.finish(90s);
    EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("2 missing"));
    EXPECT_THAT(outcome.out, HasSubstr("task " + id + "_0 (cases 0-1) did not finish its cases"));
    EXPECT_THAT(outcome.out, HasSubstr("CANCELLED"));
  }
  std::string const whole = read("cluster/cases/0.json");
  Outcome const again = gladstone(submit());
  EXPECT_EQ(again.exit_code, 0) << again.err;
  EXPECT_THAT(again.err, HasSubstr("missing cases: 2, tasks: 1,"));
  EXPECT_EQ(read("cluster/cases/0.json"), whole);
  expect_same_study();
}

// If a task is preempted or its node restarts, Slurm starts the task again, which continues with the remaining cases.
TEST_F(StudyOnACluster, ARequeuedTaskGoesOn) {
  CaseLocks claims(in("cluster").string(), CaseLocks::Use::take);
  ASSERT_TRUE(claims.take(5));
  Program program(submit(), folder_);
  std::string const id = job();
  ASSERT_TRUE(
      comes_true([this] { return process_of("4-5") > 0 && std::filesystem::exists(in("cluster/cases/4.json")); }));
  output_of("scontrol requeue " + id + "_2");
  ASSERT_TRUE(comes_true([this] { return process_of("4-5") == 0; }));
  claims.release(5);
  Outcome const outcome = program.finish(90s);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  expect_same_study();
}

// Ctrl-C ends the waiting, not the job. The same command then waits for that job and submits nothing.
TEST_F(StudyOnACluster, OutlivesTheOneWhoWaits) {
  CaseLocks claims(in("cluster").string(), CaseLocks::Use::take);
  ASSERT_TRUE(claims.take(0));
  std::string id;
  {
    Program program(submit(), folder_);
    id = job();
    program.send(SIGINT);
    Outcome const outcome = program.finish(30s);
    EXPECT_EQ(outcome.exit_code, 130) << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("scancel " + id));
  }
  EXPECT_NE(output_of("squeue --noheader --jobs=" + id), "");
  Program program(submit(), folder_);
  std::string const waits = "job " + id + " of this study is still active";
  EXPECT_TRUE(comes_true([&] { return program.err().find(waits) != std::string::npos; })) << program.err();
  claims.release(0);
  Outcome const outcome = program.finish(90s);
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  expect_same_study();
}

}  // namespace
}  // namespace gladstone::end_to_end
