#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "render/base/text_file.h"
#include "studies/demo.h"
#include "studies/sweep/plan.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;

/// Study files by the name that `make studies` has for them.
std::map<std::string, std::string> shipped_studies() {
  std::map<std::string, std::string> found;
  std::string const start = "study_";
  for (auto const& entry : fs::directory_iterator(shared_folder() + "/studies/cases")) {
    std::string const name = entry.path().stem().string();
    if (name.starts_with(start)) found[name.substr(start.size())] = entry.path().string();
  }
  return found;
}

// Small enough for two cores: fewer than 100 cases each. Planning loads the setup of every value of every axis.
TEST(ShippedStudies, CanBePlannedAndAreSmall) {
  auto const studies = shipped_studies();
  EXPECT_GE(studies.size(), 10u);
  for (auto const& [name, path] : studies) {
    std::vector<ManifestCase> const cases = plan_study(read_study(path), "cpu");
    EXPECT_GT(cases.size(), 1u) << name;
    EXPECT_LT(cases.size(), 100u) << name;
  }
}

TEST(ShippedStudies, HaveAPageWithAFigureInTheIndex) {
  std::string const docs = shared_folder() + "/docs/";
  std::string const index = read_text_file(docs + "studies.md");
  for (auto const& [name, path] : shipped_studies()) {
    EXPECT_THAT(index, testing::HasSubstr("(studies/" + name + ".md)"));
    std::string const page = read_text_file(docs + "studies/" + name + ".md");
    EXPECT_THAT(page, testing::HasSubstr("make studies STUDIES=" + name));
    ASSERT_TRUE(fs::is_directory(docs + "studies/" + name)) << name;
    int figures = 0;
    for (auto const& entry : fs::directory_iterator(docs + "studies/" + name)) {
      EXPECT_THAT(page, testing::HasSubstr("](" + name + '/' + entry.path().filename().string() + ')'));
      ++figures;
    }
    EXPECT_GT(figures, 0) << name;
  }
}

}  // namespace
}  // namespace gladstone
