#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

namespace gladstone {

/// Returns the content of a file.
inline std::string content(std::filesystem::path const& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

/// Fixture that creates a new folder for each test.
class FolderFixture : public testing::Test {
 protected:
  void SetUp() override {
    auto const* const info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("gladstone_") + info->test_suite_name() + '_' + info->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string in_folder(std::string const& name) const { return (folder_ / name).string(); }
  /// Writes a file. @return its path
  std::string write(std::string const& name, std::string const& content) const {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return in_folder(name);
  }

  std::filesystem::path folder_;
};

}  // namespace gladstone
