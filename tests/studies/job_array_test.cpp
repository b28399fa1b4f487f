#include "studies/sweep/job_array.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;

/// By default an array of sbatch has at most 1001 tasks with an index each.
constexpr std::size_t most = 1001;

std::vector<std::size_t> first_cases(std::size_t count) {
  std::vector<std::size_t> cases(count);
  for (std::size_t i = 0; i < count; ++i) cases[i] = i;
  return cases;
}

TEST(JobArray, TasksTakeConsecutiveMissingCases) {
  SlurmOptions options;
  options.cases_per_task = 3;
  options.throttle = 2;
  JobArray const array = make_job_array("/bin/gladstone", "/run", {0, 1, 2, 5, 8, 9, 40}, options, most);
  EXPECT_THAT(array.tasks, ElementsAre("0-2", "5,8-9", "40"));
  EXPECT_THAT(array.command, Contains("--array=0-2%2"));
  EXPECT_EQ(array.cases, 7u);
}

TEST(JobArray, TakesOneCaseATaskUnlessTheClusterAllowsFewerTasks) {
  EXPECT_EQ(make_job_array("g", "/run", first_cases(1001), {}, most).tasks.size(), 1001u);
  JobArray const larger = make_job_array("g", "/run", first_cases(1002), {}, most);  // 2 per task: 501 tasks
  EXPECT_EQ(larger.tasks.size(), 501u);
  EXPECT_EQ(larger.tasks.back(), "1000-1001");
}

TEST(JobArray, TooManyTasksAreRefusedWithWhatWouldFit) {
  SlurmOptions options;
  options.cases_per_task = 2;
  EXPECT_THAT([&] { make_job_array("g", "/run", first_cases(2003), options, most); },
              ThrowsDataError(ErrorCode::arguments, "--cases-per-task", HasSubstr("3")))
      << "1002 tasks in an array of 1001";
}

TEST(JobArray, GivenOptionsGoToSbatchAsTheyAre) {
  SlurmOptions options;
  options.partition = "gpu";
  options.time = "1-00:00:00";
  options.gres = "gpu:1";
  options.sbatch = {"--account=flow", "--mem=4G"};
  auto const command = make_job_array("g", "/a b/run", {0}, options, most).command;
  EXPECT_EQ(command.front(), "sbatch");
  EXPECT_EQ(command.back(), "/a b/run/slurm/job.sh");
  for (std::string const one : {"--wait", "--parsable", "--array=0-0", "--partition=gpu", "--time=1-00:00:00",
                                "--gres=gpu:1", "--account=flow", "--mem=4G", "--chdir=/a b/run"}) {
    EXPECT_THAT(command, Contains(one));
  }
}

// The script itself, run as a task: the program receives the path of the study as one argument, whatever characters it
// contains, and the cases of the line with its number.
TEST(JobArray, ScriptGivesEachTaskItsCasesWhateverThePath) {
  namespace fs = std::filesystem;
  fs::path const folder = fs::path(testing::TempDir()) / "gladstone_job_array";
  fs::remove_all(folder);
  fs::create_directories(folder);
  std::string const program = (folder / "it's $HOME; \"x\" %A").string(),
                    run = (folder / "a  b\n'c' $(false) \\").string();
  std::ofstream(program) << "#!/bin/sh\nprintf '<%s>' \"$@\"\n";
  fs::permissions(program, fs::perms::owner_all);
  SlurmOptions options;
  options.cases_per_task = 2;
  std::ofstream(folder / "job.sh") << make_job_array(program, run, {3, 4, 6, 8}, options, most).script;
  std::string const command =
      "cd '" + folder.string() + "' && SLURM_ARRAY_TASK_ID=1 SLURM_CPUS_ON_NODE=2 sh job.sh > out";
  EXPECT_EQ(std::system(command.c_str()), 0);
  std::ifstream out(folder / "out");
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(out), {}),
            "<sweep><run><" + run + "><--case><6,8><--threads><2>");
  fs::remove_all(folder);
}

TEST(ShellWord, QuotesOnlyWhatNeedsIt) {
  EXPECT_EQ(shell_word("--array=0-9%4"), "--array=0-9%4");
  EXPECT_EQ(shell_word("a b"), "'a b'");
  EXPECT_EQ(shell_word("it's"), "'it'\\''s'");
  EXPECT_EQ(shell_word(""), "''");
}

}  // namespace
}  // namespace gladstone
