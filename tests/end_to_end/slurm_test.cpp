#include <cstdlib>

#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::HasSubstr;

/// A planned study of four cases, and substitutes for Slurm's programs in a folder that is first in PATH, or the only
/// one.
class SlurmCommand : public ProgramFixture {
 protected:
  void SetUp() override {
    ProgramFixture::SetUp();
    write("study.toml", "base = \"setup.toml\"\n[axes]\n\"lens.f_number\" = [8, 11, 16, 22]\n");
    succeed({"sweep", "plan", "study.toml", "-o", "run", "--device", "cpu", "--quiet"});
    std::filesystem::create_directory(in("bin"));
  }

  void stand_in(std::string const& name, std::string const& text) const {
    write("bin/" + name, "#!/bin/sh\n" + text);
    std::filesystem::permissions(in("bin/" + name), std::filesystem::perms::owner_all);
  }
  Outcome sweep_run(std::vector<std::string> arguments, std::string const& more_path = ":/usr/bin:/bin") const {
    arguments.insert(arguments.begin(), {"sweep", "run", "run", "--slurm"});
    std::string const path = in("bin").string() + more_path;
    return run(std::move(arguments), folder_, [&] { return ::setenv("PATH", path.c_str(), 1) == 0; });
  }
};

TEST_F(SlurmCommand, DryRunShowsScriptAndCommandAndWritesNothing) {
  stand_in("sbatch", "touch submitted\n");
  auto const before = everything();
  Outcome const outcome = sweep_run({"--dry-run", "--cases-per-task", "3", "--throttle", "5", "--gres", "gpu:1"});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("\n0-2\n3\nEND\n"));
  EXPECT_THAT(outcome.out, HasSubstr("sbatch --parsable --wait"));
  EXPECT_THAT(outcome.out, HasSubstr("--array=0-1%5"));
  EXPECT_THAT(outcome.out, HasSubstr("--gres=gpu:1"));
  EXPECT_TRUE(everything() == before);
}

TEST_F(SlurmCommand, DryRunAsJsonIsOneObject) {
  Outcome const outcome = sweep_run({"--dry-run", "--json", "--sbatch=--account=flow"});
  auto const json = nlohmann::json::parse(outcome.out, nullptr, false);
  ASSERT_TRUE(json.is_object()) << outcome.out << outcome.err;
  EXPECT_EQ(json["tasks"], 4);
  EXPECT_THAT(json["command"].get<std::vector<std::string>>(), testing::Contains("--account=flow"));
  EXPECT_THAT(json["script"].get<std::string>(), testing::StartsWith("#!/bin/sh\n"));
}

TEST_F(SlurmCommand, WithoutSlurmSaysWhatIsMissing) {
  Outcome const outcome = sweep_run({"--json"}, "");
  EXPECT_EQ(outcome.exit_code, 2);
  expect_error_in(outcome, "arguments at ", {"sbatch", "--slurm"});
}

TEST_F(SlurmCommand, PassesOnWhyTheClusterRefuses) {
  stand_in("sbatch", "echo 'sbatch: error: Invalid account' >&2; exit 1\n");
  Outcome const outcome = sweep_run({"--json"});
  EXPECT_EQ(outcome.exit_code, 2);
  expect_error_in(outcome, "arguments at ", {"sbatch: error: Invalid account"});
}

TEST_F(SlurmCommand, AsksTheClusterHowLargeItsArraysMayBe) {
  stand_in("scontrol", "echo 'MaxArraySize            = 3'\n");
  EXPECT_THAT(sweep_run({"--dry-run"}).out, HasSubstr("\n0-1\n2-3\nEND\n"));  // 2 tasks of 2, since 4 would not fit
  Outcome const outcome = sweep_run({"--cases-per-task", "1", "--json"});
  EXPECT_EQ(outcome.exit_code, 2);
  expect_error_in(outcome, "arguments at --cases-per-task");
}

TEST_F(SlurmCommand, AWholeStudyIsNotSubmitted) {
  stand_in("sbatch", "touch submitted; exit 1\n");
  succeed({"sweep", "run", "run", "--quiet"});
  EXPECT_EQ(sweep_run({}).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(in("submitted")));
}

// A task that ends without a message has not finished its case: the study is incomplete, and the task is named.
TEST_F(SlurmCommand, NamesTheTasksThatLeftCasesUndone) {
  stand_in("sbatch",
           "echo 17; for last; do :; done\n"
           "for i in 0 1 3; do SLURM_ARRAY_TASK_ID=$i sh \"$last\"; done >/dev/null 2>&1\n"
           "echo 'slurmstepd: error: CANCELLED DUE TO TIME LIMIT' > \"${last%/job.sh}/17_2.log\"; exit 1\n");
  Outcome const outcome = sweep_run({});
  EXPECT_EQ(outcome.exit_code, 3) << outcome.err;
  EXPECT_THAT(outcome.out, ContainsWhole("1 missing"));
  EXPECT_THAT(outcome.out, HasSubstr("task 17_2 (cases 2)"));
  EXPECT_THAT(outcome.out, HasSubstr("CANCELLED DUE TO TIME LIMIT"));
}

TEST_F(SlurmCommand, OptionsOfTheClusterNeedTheCluster) {
  expect_error({"sweep", "run", "run", "--partition", "all"}, 2, "arguments at --partition", {"--slurm"});
}

}  // namespace
}  // namespace gladstone::end_to_end
