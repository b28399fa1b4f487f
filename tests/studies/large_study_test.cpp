#include <signal.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "render/files/hdf5_file.h"
#include "render/files/text_file.h"
#include "tests/studies/support/study_folder.h"
#include "tests/support/sanitizer.h"
#include "tests/support/study_without_work.h"

namespace gladstone {
namespace {

using test::run_in_process;
using test::StudyWithoutWork;
using test::WorkCost;

/// Studies of thousands of cases that do no work: planned, killed while running, continued and collected.
class LargeStudies : public StudyFolder {
 protected:
  StudyWithoutWork study_of(std::string const& name, std::size_t cases) const {
    std::filesystem::create_directory(folder_ / name);
    return {in(name), cases, 4};
  }
  /// Runs the cases until the process is killed while it computes one of them, which it has claimed.
  static void run_and_kill(StudyWithoutWork const& study, std::size_t at) {
    auto const kill = [at](std::size_t index) {
      if (index == at) ::raise(SIGKILL);
    };
    WorkCost const killed = run_in_process([&] { study.run(0, kill); });
    EXPECT_TRUE(WIFSIGNALED(killed.status) && WTERMSIG(killed.status) == SIGKILL) << killed.status;
  }
};

/// Cost of each stage, by its name.
using StageCosts = std::map<std::string, WorkCost>;

/// Plans a study, kills its run halfway, continues and collects it.
StageCosts costs_of(StudyWithoutWork const& study, std::size_t cases,
                    std::function<void(StudyWithoutWork const&, std::size_t)> const& run_and_kill) {
  StageCosts costs;
  costs["plan"] = run_in_process([&] { study.plan(); });
  run_and_kill(study, cases / 2);
  costs["run"] = run_in_process([&] { study.run(); });
  costs["repeat"] = run_in_process([&] { study.run(); });
  costs["collect"] = run_in_process([&] {
    if (!study.complete() || study.collect() != cases) throw DataError(ErrorCode::inconsistent, "study", "incomplete");
  });
  return costs;
}

// Time: if it is proportional to the number of cases, the time per case is the same for both studies; if it is
// proportional to the square, that of ten times as many cases is ten times as long. The limit, sqrt(10), leaves a
// factor of 3.2 to both. Processor time, which other programs hardly affect.
//
// Memory: a run holds 8 bytes per case for the end of its line in the manifest, for the selection, and for the cases
// to do: 24 bytes, up to twice that where vectors grow. A buffer of 4 MiB for the manifest is filled by the larger
// study only. A table holds 98 measures of 8 bytes per case, 784 bytes, and at most 300 bytes for the rest of row and
// point (study_table.h); with the formatted result in place of numbers it would be over 3000.
TEST_F(LargeStudies, TakeTheSameTimeAndMemoryPerCaseAsSmallOnes) {
  constexpr std::size_t few = 1000, many = 10000;
  StageCosts small = costs_of(study_of("few", few), few, run_and_kill);
  StageCosts large = costs_of(study_of("many", many), many, run_and_kill);
  constexpr double buffer = 4 << 20;
  std::map<std::string, double> const bytes_per_case{{"plan", 50}, {"run", 50}, {"repeat", 50}, {"collect", 1084}};
  for (auto const& [stage, most_bytes] : bytes_per_case) {
    ASSERT_EQ(small[stage].status, 0) << stage;
    ASSERT_EQ(large[stage].status, 0) << stage;
    double const slower = large[stage].seconds / many / (small[stage].seconds / few);
    double const growth = large[stage].bytes - small[stage].bytes;
    RecordProperty(stage + "_time_ratio", std::to_string(slower));
    RecordProperty(stage + "_ms_per_case", std::to_string(1e3 * large[stage].seconds / many));
    RecordProperty(stage + "_bytes_per_case", std::to_string(growth / (many - few)));
    EXPECT_LT(slower, std::sqrt(10.0)) << stage;
    if (test::address_sanitizer) continue;
    EXPECT_LT(growth, buffer + most_bytes * (many - few)) << stage;
  }
}

// One process is killed between the claim of a case and its result, another one between the result and the release of
// the claim. Two others continue at the same time. Every file of a result, and the tables, equal those of a run that
// was not disturbed.
TEST_F(LargeStudies, HaveTheSameResultsAfterInterruptions) {
  constexpr std::size_t cases = 1000;
  StudyWithoutWork const whole = study_of("whole", cases), parts = study_of("parts", cases);
  auto const finish = [](StudyWithoutWork const& study) {
    ASSERT_EQ(run_in_process([&] { study.run(); }).status, 0);
    ASSERT_EQ(run_in_process([&] { study.collect(); }).status, 0);
  };
  whole.plan();
  finish(whole);

  parts.plan();
  run_and_kill(parts, 350);
  WorkCost const killed = run_in_process([&] {
    parts.run(0.5, {}, [](std::size_t index) {
      if (index == 650) ::raise(SIGKILL);
    });
  });
  EXPECT_TRUE(WIFSIGNALED(killed.status)) << killed.status;
  EXPECT_TRUE(has_result(parts.run_folder(), 650));
  EXPECT_FALSE(has_result(parts.run_folder(), 350));
  EXPECT_FALSE(has_result(parts.run_folder(), 651));
  pid_t const other = ::fork();
  if (other == 0) ::_exit(run_in_process([&] { parts.run(0.5); }).status == 0 ? 0 : 1);
  finish(parts);
  int status = 0;
  ::waitpid(other, &status, 0);
  EXPECT_EQ(status, 0);

  std::string const first = whole.run_folder(), second = parts.run_folder();
  for (std::size_t index = 0; index < cases; ++index) {
    ASSERT_EQ(read_text_file(result_path(first, index)), read_text_file(result_path(second, index))) << index;
  }
  EXPECT_EQ(read_text_file(first + "/study.csv"), read_text_file(second + "/study.csv"));
  Hdf5Reader const one(first + "/study.h5"), two(second + "/study.h5");
  std::vector<std::string> const names = one.number_datasets();
  EXPECT_GT(names.size(), StudyWithoutWork::measures);
  EXPECT_EQ(names, two.number_datasets());
  for (std::string const& name : names) {
    std::vector<double> const a = one.read(name), b = two.read(name);
    EXPECT_TRUE(std::equal(a.begin(), a.end(), b.begin(), b.end(), [](double x, double y) {
      return x == y || (std::isnan(x) && std::isnan(y));
    })) << name;
  }
}

}  // namespace
}  // namespace gladstone
