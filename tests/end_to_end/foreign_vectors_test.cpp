#include <fmt/format.h>

#include "tests/end_to_end/support/workplace.h"

namespace gladstone::end_to_end {
namespace {

/// The case's own vectors written as other codes write them: compare must find the conventions and the same errors.
class ForeignVectors : public Workplace {
 protected:
  void SetUp() override {
    Workplace::SetUp();
    // a wave, so that a place taken for another shows; its amplitude gives a few tenths of a pixel
    std::string const wave = with(
        with(small_setup, "[64, 64]", "[128, 128]"), "kind = \"uniform_gradient\"\ngradient_kg_m4 = [20.0, 10.0, 0.0]",
        "kind = \"sinusoid\"\namplitude_kg_m3 = 0.05\nwavelength_mm = 8.0\ndirection = [1, 0.6]");
    write("setup.toml", wave);
    render("case", {"--set", "target.dots_per_32px_window=25"});
    succeed({"correlate", "case"});
    ours_ = compare({});
    Hdf5Reader const file(in("case/vectors.h5").string());
    x_ = file.read("x_px");
    y_ = file.read("y_px");
    u_ = file.read("u_px");
    v_ = file.read("v_px");
  }
  nlohmann::json compare(std::vector<std::string> const& more) const {
    std::vector<std::string> arguments{"compare", "case", "--no-figures"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return json_of(arguments);
  }
  void expect_same_errors(nlohmann::json const& other) const {
    for (char const* truth : {"ray_truth", "eq9", "eq9_cone"}) {
      for (char const* measure : {"count", "rms_px", "bias_u_px", "bias_v_px", "p95_px"}) {
        EXPECT_NEAR(other[truth][measure].get<double>(), ours_[truth][measure].get<double>(), 1e-6)
            << truth << ' ' << measure;
      }
    }
  }
  nlohmann::json ours_;
  std::vector<double> x_, y_, u_, v_;
};

TEST_F(ForeignVectors, OurOwnText) {
  succeed({"correlate", "case", "-o", "v.csv"});
  expect_same_errors(compare({"--vectors", "v.csv"}));
}

TEST_F(ForeignVectors, ErrorsAreThoseOfTheLastComparison) {
  std::string const own = read("case/errors.json");
  std::string text = "x,y,u,v\n";
  for (std::size_t i = 0; i < x_.size(); ++i) text += fmt::format("{},{},{},{}\n", x_[i], y_[i], u_[i] + 0.1, v_[i]);
  write("other.csv", text);
  succeed({"compare", "case", "--vectors", "other.csv"});
  EXPECT_NEAR(nlohmann::json::parse(read("case/errors.json"))["ray_truth"]["bias_u_px"].get<double>(),
              ours_["ray_truth"]["bias_u_px"].get<double>() + 0.1, 1e-6);
  EXPECT_TRUE(std::filesystem::exists(in("case/error_budget.png")));
  succeed({"compare", "case", "--no-figures"});
  EXPECT_EQ(read("case/errors.json"), own);
}

TEST_F(ForeignVectors, OpenPivTurnsTheYAxisAndCountsFromTheEdge) {
  // OpenPIV's transform_coordinates: y turned round about the grid, v with it; x = ws/2 where we say (ws - 1)/2
  double const low = *std::min_element(y_.begin(), y_.end()), high = *std::max_element(y_.begin(), y_.end());
  std::string text = "# x\ty\tu\tv\tflags\tmask\n";
  for (std::size_t i = 0; i < x_.size(); ++i) {
    text += fmt::format("{:.9f}\t{:.9f}\t{:.9f}\t{:.9f}\t0\t0\n", x_[i] + 0.5, low + high - y_[i] + 0.5, u_[i], -v_[i]);
  }
  write("openpiv.txt", text);
  auto const errors = compare({"--vectors", "openpiv.txt"});
  expect_same_errors(errors);
  std::string const report = errors["vectors"]["conventions"];
  EXPECT_THAT(report, testing::HasSubstr("OpenPIV vectors read as y-up,v-up,offset=-0.5"));
  EXPECT_TRUE(errors["budget"]["terms"]["noise"]["rms_px"].is_null()) << "unknown for a foreign code";
  expect_same_errors(compare({"--vectors", "openpiv.txt", "--conventions", "y-up,v-up,offset=-0.5"}));
}

TEST_F(ForeignVectors, PivlabCountsFromOne) {
  std::string text =
      "PIVlab, ASCII chart output\nFrames: 1 2\nx [px],y [px],u [px/frame],v [px/frame],vector type [-]\n";
  for (std::size_t i = 0; i < x_.size(); ++i) {
    text += fmt::format("{:.9f},{:.9f},{:.9f},{:.9f},1\n", x_[i] + 1.5, y_[i] + 1.5, u_[i], v_[i]);
  }
  write("pivlab.txt", text);
  auto const errors = compare({"--vectors", "pivlab.txt"});
  expect_same_errors(errors);
  std::string const report = errors["vectors"]["conventions"];
  EXPECT_THAT(report, testing::HasSubstr("PIVlab vectors read as y-down,v-down,offset=-1.5"));
}

TEST_F(ForeignVectors, FramesTakenTheOtherWayRoundAreFound) {
  std::string text = "x,y,u,v\n";
  for (std::size_t i = 0; i < x_.size(); ++i)
    text += fmt::format("{:.9f},{:.9f},{:.9f},{:.9f}\n", x_[i], y_[i], -u_[i], -v_[i]);
  write("swapped.csv", text);
  auto const errors = compare({"--vectors", "swapped.csv"});
  expect_same_errors(errors);
  EXPECT_THAT(errors["vectors"]["conventions"].get<std::string>(), testing::HasSubstr("swapped"));
}

TEST_F(ForeignVectors, ToldConventionsMustBeWords) {
  expect_refused({"compare", "case", "--conventions", "sideways"}, 2, {"unknown word \"sideways\"", "y-up"});
}

}  // namespace
}  // namespace gladstone::end_to_end
