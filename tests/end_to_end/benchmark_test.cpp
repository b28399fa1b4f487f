#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <random>

#include "analysis/vectors/convention_detection.h"
#include "analysis/vectors/convention_report.h"
#include "studies/benchmark/benchmark_cases.h"
#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

class Benchmark : public ProgramFixture {};

nlohmann::json score_of(nlohmann::json const& benchmark, std::string const& estimator, std::string const& of_case) {
  for (auto const& row : benchmark["scores"])
    if (row["estimator"] == estimator && row["case"] == of_case) return row;
  return nullptr;
}

// The published pair measured by the program itself and submitted as files of another code: once in our format, and
// once as OpenPIV writes them, y upwards about the grid and with an offset of half a pixel. Both must have the scores
// of the built-in estimator.
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

TEST_F(Benchmark, ReportsTheCoverageOfTheUncertainty) {
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

// The shipped weights are those that the program learns on any machine with the same arithmetic: four digits are
// written, and rounding in single precision changes the weights by much less than a thousandth.
TEST_F(Benchmark, LearnsTheCombinationThatShips) {
  // 20 s of work, minutes on a busy machine
  Outcome const outcome =
      Program({"benchmark", "-o", "learnt", "--learn", "--device", "cpu", "--json"}, folder_).finish(hang_limit);
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

/// Vectors of a code for `uniform` and `vortex`, every 16 px, with a changed truth taken at another position.
template <class Change>
std::map<std::string, std::string> changed_truth(Change const& change, Vec2d shift_px = {}) {
  std::map<std::string, std::string> files;
  for (std::string const name : {"uniform", "vortex"}) {
    BenchmarkCase const& of = *std::find_if(benchmark_cases().begin(), benchmark_cases().end(),
                                            [&](BenchmarkCase const& one) { return one.name == name; });
    std::string text = "x,y,u,v\n";
    for (int y = 16; y < 1024; y += 16) {
      for (int x = 16; x < 1024; x += 16) {
        Vec2d const d = change(of.flow(Vec2d{static_cast<double>(x), static_cast<double>(y)} - shift_px));
        text += fmt::format("{},{},{:.9g},{:.9g}\n", x, y, d.x, d.y);
      }
    }
    files[name + ".csv"] = text;
  }
  return files;
}

// The negative of the truth has an error of twice its rms in any case. The vortex alone does not distinguish exchanged
// frames from axes that point up, and the uniform displacement not from exchanged columns, but both together do.
// Exchanged columns of displacements are reported, too.
TEST_F(Benchmark, ForgivesNoWrongSigns) {
  auto const write_all = [&](std::string const& folder, auto const& files) {
    std::filesystem::create_directories(in(folder));
    for (auto const& [name, text] : files) write(folder + '/' + name, text);
  };
  write_all("negative", changed_truth([](Vec2d d) { return -d; }));
  write_all("turned", changed_truth([](Vec2d d) { return Vec2d{d.y, d.x}; }));
  write_all("right", changed_truth([](Vec2d d) { return d; }));
  std::vector<std::string> const run{"benchmark", "-o", "b", "--estimators", "none", "--no-figures", "--json"};
  auto const score = [&](std::vector<std::string> const& more) {
    std::vector<std::string> arguments = run;
    arguments.insert(arguments.end(), more.begin(), more.end());
    return gladstone(arguments);
  };
  Outcome const negative = score({"--cases", "vortex", "uniform", "--vectors", "m=negative"});
  EXPECT_EQ(negative.exit_code, 1) << negative.err;
  auto const scored = nlohmann::json::parse(negative.out);
  EXPECT_EQ(scored["likely_mistakes"].size(), 1u);
  EXPECT_NEAR(score_of(scored, "m", "uniform")["rms_px"].get<double>(), 0.6, 1e-6);
  EXPECT_LT(score_of(scored, "m", "vortex")["gain"].get<double>(), -0.9);
  VectorConventions exchanged;
  exchanged.swapped = true;
  EXPECT_THAT(scored["likely_mistakes"].dump(), testing::HasSubstr(describe_difference(exchanged, {})));

  Outcome const alone = score({"--cases", "vortex", "--vectors", "m=negative"});
  EXPECT_EQ(alone.exit_code, 1) << alone.err;
  EXPECT_THAT(nlohmann::json::parse(alone.out)["likely_mistakes"].dump(),
              testing::AllOf(testing::HasSubstr("vortex"), testing::HasSubstr("turbulence")));

  Outcome const turned = score({"--cases", "vortex", "uniform", "--vectors", "m=turned"});
  EXPECT_EQ(turned.exit_code, 1) << turned.err;
  EXPECT_THAT(nlohmann::json::parse(turned.out)["likely_mistakes"].dump(), testing::HasSubstr("components-exchanged"));

  Outcome const told =
      score({"--cases", "vortex", "uniform", "--vectors", "m=negative", "--conventions", "m=frames-exchanged"});
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_LT(score_of(nlohmann::json::parse(told.out), "m", "uniform")["rms_px"].get<double>(), 1e-6);
  Outcome const right = score({"--cases", "vortex", "uniform", "--vectors", "m=right"});
  EXPECT_EQ(right.exit_code, 0) << right.err;
  EXPECT_EQ(nlohmann::json::parse(right.out)["likely_mistakes"].size(), 0u);
}

// Each mistake is the same in both cases; the uniform displacement does not show a shift, and does not distinguish an
// offset from a factor. Vectors with random factors follow the truth, and no correction explains them.
TEST_F(Benchmark, FindsOneMistakeInAllCases) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> factor(0.5, 2.0);
  struct Wrong {
    std::vector<std::string> values;  ///< numbers in the warning
    std::map<std::string, std::string> files;
  };
  for (Wrong const& wrong : {
           Wrong{{"(16, 0) px"}, changed_truth([](Vec2d d) { return d; }, {16.0, 0.0})},
           Wrong{{"(0.5, 0) px"}, changed_truth([](Vec2d d) {
                   return d + Vec2d{0.5, 0.0};
                 })},
           Wrong{{"px/frame=1.1"}, changed_truth([](Vec2d d) { return 1.1 * d; })},
           Wrong{{"px/frame=10"}, changed_truth([](Vec2d d) { return 10.0 * d; })},
           Wrong{{"2 of 2", "30 %"}, changed_truth([&](Vec2d d) { return factor(random) * d; })},
       }) {
    std::filesystem::create_directories(in("wrong"));
    for (auto const& [name, text] : wrong.files) write("wrong/" + name, text);
    Outcome const outcome = gladstone({"benchmark", "-o", "b", "--estimators", "none", "--no-figures", "--cases",
                                       "vortex", "uniform", "--vectors", "m=wrong"});
    EXPECT_EQ(outcome.exit_code, 1) << wrong.values[0] << outcome.err;
    for (std::string const& value : wrong.values) EXPECT_THAT(outcome.err, ContainsWhole(value));
    EXPECT_THAT(outcome.out, testing::Not(testing::HasSubstr("nan")));
  }
}

// 63 x 63 vectors 16 px apart: 31 rows of them are 1953, and one duplicate row has 63.
TEST_F(Benchmark, RefusesHalfAGridAndRowsGivenTwice) {
  std::string const whole = changed_truth([](Vec2d d) { return d; }).at("uniform.csv");
  auto const lines = [&](std::size_t count) {
    std::size_t at = 0;
    for (std::size_t i = 0; i < count; ++i) at = whole.find('\n', at) + 1;
    return whole.substr(0, at);
  };
  auto const refused = [&](std::string const& text, std::vector<std::string> const& counts) {
    write("uniform.csv", text);
    Outcome const outcome = gladstone(
        {"benchmark", "-o", "b", "--cases", "uniform", "--estimators", "none", "--vectors", "m=uniform.csv", "--json"});
    EXPECT_EQ(outcome.exit_code, 2) << outcome.err;
    expect_error_in(outcome, "inconsistent at uniform.csv", counts);
  };
  // rows are expected down to 96 px from the lower border: up to y = 912, the 57th row
  refused(lines(1 + 31 * 63), {"1953", "3591"});
  refused(whole + lines(64).substr(8), {"63 of 4032"});
  std::string gap = whole;
  std::size_t const at = gap.find("\n512,512,") + 1;
  gap.erase(at, gap.find('\n', at) + 1 - at);
  refused(gap, {"3968", "3969"});
}

TEST_F(Benchmark, RefusesWhatItCannotScore) {
  expect_error({"benchmark", "-o", "b", "--cases", "vortx"}, 2, "arguments at --cases", {"\"vortx\"", "\"vortex\""});
  expect_error({"benchmark", "-o", "b", "--vectors", "mine"}, 2, "arguments at --vectors", {"\"mine\"", "NAME=F"});
  expect_error({"benchmark", "-o", "b", "--vectors", "mine=nowhere"}, 2, "missing_file at nowhere");
  expect_error({"benchmark", "-o", "b", "--vectors", "default=."}, 2, "arguments at --vectors", {"\"default=.\""});
  std::filesystem::create_directories(in("empty"));
  expect_error({"benchmark", "-o", "b", "--cases", "shear", "--vectors", "mine=empty"}, 2, "missing_content at empty",
               {"shear.csv"});
  std::filesystem::create_directories(in("unknown"));
  write("unknown/shear.csv", "x_px,y_px,u_px,v_px\n100,100,nan,nan\n120,100,nan,nan\n");
  Outcome const outcome = gladstone(
      {"benchmark", "-o", "b", "--cases", "shear", "--vectors", "mine=unknown", "--estimators", "none", "--json"});
  EXPECT_EQ(outcome.exit_code, 2);
  expect_error_in(outcome, "missing_content at shear.csv");
}

}  // namespace
}  // namespace gladstone::end_to_end
