#include <gtest/gtest.h>
#include <stdlib.h>

#include <filesystem>
#include <stdexcept>
#include <string>

namespace gladstone {
namespace {

namespace fs = std::filesystem;

/// ctest runs tests of one fixture side by side, each in a process of its own: gives this process a TempDir() of its
/// own, and removes it at the end.
class OwnFolder final : public ::testing::Environment {
 public:
  void SetUp() override {
    folder_ = ::testing::TempDir() + "XXXXXX";
    if (::mkdtemp(folder_.data()) == nullptr) throw std::runtime_error(folder_ + ": cannot be made");
    fs::permissions(folder_, fs::perms(0755));  // some tests are another user for a moment
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
