#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>

#include "render/files/text_file.h"
#include "studies/case/shared_folder.h"
#include "studies/sweep/plan.h"

namespace gladstone {
namespace {

namespace fs = std::filesystem;

/// Study files by their names in `make studies`.
std::map<std::string, std::string> shipped_studies() {
  std::map<std::string, std::string> found;
  std::string const start = "study_";
  for (auto const& entry : fs::directory_iterator(shared_folder() + "/studies/cases")) {
    std::string const name = entry.path().stem().string();
    if (name.starts_with(start)) found[name.substr(start.size())] = entry.path().string();
  }
  return found;
}

// Small enough for two cores: fewer than 150 cases each; random_error, the largest, has 144 of small images, two
// minutes on one core. Planning loads the setup of every value of every axis.
TEST(ShippedStudies, CanBePlannedAndAreSmall) {
  auto const studies = shipped_studies();
  EXPECT_GE(studies.size(), 10u);
  for (auto const& [name, path] : studies) {
    StudyPlan const cases = plan_study(read_study(path), "cpu");
    EXPECT_GT(cases.size(), 1u) << name;
    EXPECT_LT(cases.size(), 150u) << name;
  }
}

TEST(ShippedStudies, AreInTheIndexAndTheirPagesShowFiguresThatThereAre) {
  std::string const docs = shared_folder() + "/docs/";
  std::string const index = read_text_file(docs + "studies.md");
  int figures = 0;
  for (auto const& [name, path] : shipped_studies()) {
    EXPECT_THAT(index, testing::HasSubstr("| [" + name + "]"));
    std::string const page_path = docs + "studies/" + name + ".md";
    bool const linked = index.find("(studies/" + name + ".md)") != std::string::npos;
    EXPECT_EQ(fs::exists(page_path), linked) << name;
    if (!linked) continue;
    std::string const page = read_text_file(page_path);
    EXPECT_THAT(page, testing::HasSubstr("make studies STUDIES=" + name));
    std::string const link = "](" + name + "/";
    for (std::size_t at = page.find(link); at != std::string::npos; at = page.find(link, at + 1)) {
      std::string const figure = page.substr(at + 2, page.find(')', at) - at - 2);
      if (!figure.ends_with(".png")) continue;
      EXPECT_TRUE(fs::exists(docs + "studies/" + figure)) << figure;
      ++figures;
    }
  }
  EXPECT_GE(figures, 15);
}

// docs/benchmarks.md gives times for these numbers of cases.
TEST(BenchmarkStudies, HaveTheNumberOfCasesOfTheirName) {
  std::string const folder = shared_folder() + "/data/benchmarks/";
  EXPECT_EQ(plan_study(read_study(folder + "study_hundred.toml"), "cpu").size(), 100u);
  EXPECT_EQ(plan_study(read_study(folder + "study_thousand.toml"), "cpu").size(), 1000u);
}

}  // namespace
}  // namespace gladstone
