#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>

#include "studies/sweep/plan.h"
#include "tests/support/expect_error.h"
#include "tests/support/folder_fixture.h"

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
class StudyFolder : public FolderFixture {
 protected:
  void SetUp() override {
    FolderFixture::SetUp();
    write("base.toml", small_base);
  }

  std::string in(std::string const& name) const { return in_folder(name); }
  StudyFile study(std::string const& text) const {
    write("study.toml", text);
    return read_study(in("study.toml"));
  }
  std::vector<ManifestCase> plan(std::string const& text) const { return all_cases(plan_study(study(text), "cpu")); }

  /// Returns "CODE at PLACE" of each error of planning the study; empty if planning succeeds.
  std::string complaint(std::string const& text) const {
    return error_of([&] { plan(text); });
  }
};

}  // namespace gladstone
