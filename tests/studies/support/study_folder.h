#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "studies/sweep/plan.h"
#include "tests/support/expect_error.h"

namespace gladstone {

/// Setup that is rendered in some milliseconds.
inline constexpr char const* small_base = R"(schema = 1
[camera]
pixels = [64, 64]
[lens]
f_number = 11.0
[medium.field]
kind = "uniform_gradient"
gradient_kg_m4 = [20.0, 10.0, 0.0]
[target]
dots_per_32px_window = 10.0
[render]
rays_per_dot = 32
[correlate]
window_px = [32, 16]
overlap = 0.5
)";

inline std::vector<ManifestCase> all_cases(StudyPlan const& plan) {
  std::vector<ManifestCase> cases;
  for (std::size_t i = 0; i < plan.size(); ++i) cases.push_back(plan[i]);
  return cases;
}

/// Fixture that creates a new folder with a base setup for each test.
class StudyFolder : public testing::Test {
 protected:
  void SetUp() override {
    auto const* const info = testing::UnitTest::GetInstance()->current_test_info();
    folder_ = std::filesystem::path(testing::TempDir()) /
              (std::string("gladstone_") + info->test_suite_name() + '_' + info->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
    write("base.toml", small_base);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string in(std::string const& name) const { return (folder_ / name).string(); }
  void write(std::string const& name, std::string const& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  StudyFile study(std::string const& text) const {
    write("study.toml", text);
    return read_study(in("study.toml"));
  }
  std::vector<ManifestCase> plan(std::string const& text) const { return all_cases(plan_study(study(text), "cpu")); }

  /// Returns "CODE at PLACE" of each error of planning the study; empty if planning succeeds.
  std::string complaint(std::string const& text) const {
    return error_of([&] { plan(text); });
  }

  std::filesystem::path folder_;
};

}  // namespace gladstone
