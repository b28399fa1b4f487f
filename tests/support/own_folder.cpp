#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>
#include <string>

namespace gladstone {
namespace {

namespace fs = std::filesystem;

/// Returns true if any user may enter a directory and all of its parents.
bool all_may_enter(fs::path folder) {
  for (folder = fs::absolute(folder); folder.has_relative_path(); folder = folder.parent_path()) {
    if ((fs::status(folder).permissions() & fs::perms::others_exec) == fs::perms::none) return false;
  }
  return true;
}

/// Gives each test process its own TempDir(), removed at the end, since ctest runs the tests of one fixture
/// concurrently in separate processes.
class OwnFolder final : public ::testing::Environment {
 public:
  void SetUp() override {
    // If run by root, some tests temporarily switch to another user, who cannot enter root's home directory.
    bool const here = ::geteuid() != 0 || all_may_enter(::testing::TempDir());
    folder_ = here ? ::testing::TempDir() + "XXXXXX" : (fs::temp_directory_path() / "gladstone-test-XXXXXX").string();
    if (::mkdtemp(folder_.data()) == nullptr) throw std::runtime_error(folder_ + ": cannot be created");
    fs::permissions(folder_, fs::perms(0755));
    ::setenv("TEST_TMPDIR", folder_.c_str(), 1);
  }
  void TearDown() override {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }

 private:
  std::string folder_;
};

[[maybe_unused]] ::testing::Environment* const own_folder = ::testing::AddGlobalTestEnvironment(new OwnFolder);

}  // namespace
}  // namespace gladstone
