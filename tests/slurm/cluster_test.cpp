#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <string>

namespace {

/// Exit code of a shell command line; -1 where it was killed.
int shell(std::string const& command) {
  int const status = std::system(command.c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

// The other tests rely on this: sbatch --wait returns the largest exit code of an array's tasks, 1 for a task that was
// ended by a signal, and 0 if the array runs again without a failure.
TEST(Cluster, ReturnsExitCodeOfFailedTask) {
  std::string const submit = "sbatch --quiet --wait --output=/dev/null --array=0-2 --wrap ";
  EXPECT_EQ(shell(submit + "'test $SLURM_ARRAY_TASK_ID != 1 || exit 7'"), 7);
  EXPECT_EQ(shell(submit + "'test $SLURM_ARRAY_TASK_ID != 1 || kill -9 $$'"), 1);
  EXPECT_EQ(shell(submit + "true"), 0);
}

}  // namespace
