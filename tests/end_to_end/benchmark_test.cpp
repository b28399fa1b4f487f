#include <fmt/format.h>

#include <fstream>

#include "tests/end_to_end/support/workplace.h"

namespace gladstone::end_to_end {
namespace {

class Benchmark : public Workplace {};

nlohmann::json score_of(nlohmann::json const& benchmark, std::string const& estimator, std::string const& of_case) {
  for (auto const& row : benchmark["scores"])
    if (row["estimator"] == estimator && row["case"] == of_case) return row;
  return nullptr;
}

// The published pair measured by the program itself and handed in as another code's files: ours, and as OpenPIV writes
// them, y upwards about the grid and half a pixel off. Both must score as the same estimator does inside.
TEST_F(Benchmark, ScoresTheVectorsOfAnyCode) {
  auto const ours = json_of({"benchmark", "-o", "b", "--cases", "vortex", "noise_5", "--estimators", "one_pass"});
  for (char const* name : {"b/vortex/reference.tif", "b/vortex/flow.tif", "b/vortex/truth.csv", "b/noise_5/truth.csv",
                           "b/benchmark.html", "b/benchmark.md", "b/benchmark.json", "b/benchmark.csv"})
    EXPECT_TRUE(std::filesystem::exists(in(name))) << name;
  EXPECT_TRUE(score_of(ours, "default", "vortex").is_null());
  std::filesystem::create_directories(in("mine"));
  std::filesystem::create_directories(in("openpiv"));
  for (std::string const name : {"vortex", "noise_5"}) {
    succeed({"correlate", "b/" + name + "/reference.tif", "b/" + name + "/flow.tif", "-o", "mine/" + name + ".h5",
             "--set", "correlate.window_px=[32]", "--set", "correlate.overlap=0.5"});
    Hdf5Reader const file(in("mine/" + name + ".h5").string());
    std::vector<double> const x = file.read("x_px"), y = file.read("y_px"), u = file.read("u_px"),
                              v = file.read("v_px");
    std::string text = "# x\ty\tu\tv\tflags\tmask\n";
    for (std::size_t i = 0; i < x.size(); ++i)
      text += fmt::format("{:.9f}\t{:.9f}\t{:.9f}\t{:.9f}\t{}\t0\n", x[i] + 0.5, y.front() + y.back() - y[i] + 0.5,
                          u[i], -v[i], u[i] == u[i] ? 0 : 1);
    write("openpiv/" + name + ".txt", text);
  }
  auto const others = json_of({"benchmark", "-o", "b", "--cases", "noise_5", "vortex", "--estimators", "none",
                               "--vectors", "mine=mine", "other=openpiv"});
  for (std::string const name : {"vortex", "noise_5"}) {
    auto const inside = score_of(ours, "one_pass", name);
    for (char const* code : {"mine", "other"}) {
      auto const found = score_of(others, code, name);
      ASSERT_FALSE(found.is_null()) << code << name;
      for (char const* measure : {"vectors", "count", "gross", "rms_px", "gain", "bias_u_px", "bias_v_px"})
        EXPECT_NEAR(found[measure].get<double>(), inside[measure].get<double>(), 1e-6) << code << name << measure;
    }
  }
  EXPECT_THAT(others["conventions"].dump(), testing::HasSubstr("y-up,v-up,offset=-0.5"));
  // the cases are published: the same frames in every run
  EXPECT_EQ(ours["cases"], others["cases"]);
  EXPECT_THAT(read("b/benchmark.csv"), testing::HasSubstr("other,noise_5,"));
  EXPECT_THAT(read("b/benchmark.html"), testing::HasSubstr("vortex"));
}

TEST_F(Benchmark, TellsWhatSigmaIsWorth) {
  auto const found = json_of({"benchmark", "-o", "b", "--cases", "noise_5", "--estimators", "default"});
  bool seen = false;
  for (auto const& row : found["uncertainty"]) {
    if (row["method"] != "correlation_statistics") continue;
    seen = true;
    for (char const* truth : {"window_truth", "deformed_window_truth", "point_truth"})
      EXPECT_NEAR(row[truth]["coverage_1"].get<double>(), 0.68, 0.06) << truth;
    EXPECT_EQ(row["bins"].size(), 10u);
  }
  EXPECT_TRUE(seen);
  EXPECT_TRUE(std::filesystem::exists(in("b/error_against_uncertainty.png")));
  EXPECT_THAT(read("b/benchmark.md"), testing::HasSubstr("error_against_uncertainty.png"));
}

// What ships is what the program learns, on any machine of the same arithmetic: four digits are written, and the
// weights may be off by as much as rounding in single precision moves them, of which a thousandth is ample.
TEST_F(Benchmark, LearnsTheCombinationThatShips) {
  // 20 s of work, which a busy machine makes minutes
  Outcome const outcome = Program({"benchmark", "-o", "learnt", "--learn", "--device", "cpu", "--json"}, folder_)
                              .finish(std::chrono::minutes(10));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  auto const learnt = nlohmann::json::parse(outcome.out);
  std::ifstream shipped(GLADSTONE_DATA_DIR "/uncertainty/combination.csv");
  std::istringstream again(read("learnt/combination.csv"));
  std::string line, line_again;
  ASSERT_TRUE(std::getline(shipped, line) && std::getline(again, line_again));
  EXPECT_EQ(line, "term,coefficient");
  EXPECT_EQ(line_again, line);
  std::size_t terms = 0;
  for (; std::getline(shipped, line); ++terms) {
    ASSERT_TRUE(std::getline(again, line_again)) << line;
    auto const comma = line.find(',');
    std::string const term = line.substr(0, comma);
    EXPECT_EQ(line_again.substr(0, line_again.find(',')), term);
    double const weight = std::stod(line.substr(comma + 1));
    EXPECT_NEAR(std::stod(line_again.substr(line_again.find(',') + 1)), weight, 1e-3) << term;
    EXPECT_NEAR(learnt[term].get<double>(), weight, 1e-3) << term;
  }
  EXPECT_EQ(terms, 5u);
  EXPECT_FALSE(std::filesystem::exists(in("learnt/benchmark.html")));
}

TEST_F(Benchmark, RefusesWhatItCannotScore) {
  expect_refused({"benchmark", "-o", "b", "--cases", "vortx"}, 2, {"vortx", "did you mean \"vortex\"?"});
  expect_refused({"benchmark", "-o", "b", "--vectors", "mine"}, 2, {"--vectors mine", "NAME=F"});
  expect_refused({"benchmark", "-o", "b", "--vectors", "mine=nowhere"}, 2, {"nowhere", "is not there"});
  expect_refused({"benchmark", "-o", "b", "--vectors", "default=."}, 2, {"name of one of our estimators"});
  std::filesystem::create_directories(in("empty"));
  expect_refused({"benchmark", "-o", "b", "--cases", "shear", "--vectors", "mine=empty"}, 2, {"empty", "shear.csv"});
  std::filesystem::create_directories(in("unknown"));
  write("unknown/shear.csv", "x_px,y_px,u_px,v_px\n100,100,nan,nan\n120,100,nan,nan\n");
  Outcome const outcome =
      gladstone({"benchmark", "-o", "b", "--cases", "shear", "--vectors", "mine=unknown", "--estimators", "none"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(outcome.err, testing::HasSubstr("unknown/shear.csv: holds no displacement that is a number"));
}

}  // namespace
}  // namespace gladstone::end_to_end
