#include <fmt/format.h>

#include <functional>
#include <limits>
#include <utility>

#include "render/base/vec.h"
#include "tests/end_to_end/support/workplace.h"

namespace gladstone::end_to_end {
namespace {

/// The case's own vectors written as other codes write them: compare must find the conventions and the same errors.
class ForeignVectors : public Workplace {
 protected:
  void SetUp() override {
    Workplace::SetUp();
    // A wave, so that a place taken for another shows: its amplitude gives half a pixel, and half a pixel of place some
    // hundredths of it. It runs so near to x that it does not look like itself with x and y exchanged.
    std::string const wave = with(
        with(small_setup, "[64, 64]", "[128, 128]"), "kind = \"uniform_gradient\"\ngradient_kg_m4 = [20.0, 10.0, 0.0]",
        "kind = \"sinusoid\"\namplitude_kg_m3 = 0.15\nwavelength_mm = 8.0\ndirection = [1, 0.3]");
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
  using Change = std::function<void(std::size_t, Vec2d& place, Vec2d& displacement)>;
  /// The case's own vectors as a plain table, changed one by one.
  void write_changed(std::string const& name, Change const& change) const {
    std::string text = "x,y,u,v\n";
    for (std::size_t i = 0; i < x_.size(); ++i) {
      Vec2d place{x_[i], y_[i]}, displacement{u_[i], v_[i]};
      change(i, place, displacement);
      text += fmt::format("{},{},{},{}\n", place.x, place.y, displacement.x, displacement.y);
    }
    write(name, text);
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

// Numbers that no camera gives: each vector is left out with its reason, and the others are compared as ever.
TEST_F(ForeignVectors, ImpossibleOnesAreLeftOutAndCounted) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  write_changed("some.csv", [&](std::size_t i, Vec2d& place, Vec2d& displacement) {
    if (i == 0) place.x = nan;
    if (i == 1) place.y = 1e15;
    if (i == 2) place.x = -std::numeric_limits<double>::infinity();
    if (i == 3) place.x = 1e6;
    if (i == 4) displacement.x = 1e308;
    if (i == 5) displacement.y = nan;
  });
  auto const errors = compare({"--vectors", "some.csv"});
  nlohmann::json const& vectors = errors["vectors"];
  EXPECT_EQ(vectors["total"], x_.size());
  EXPECT_EQ(vectors["left_out_place_not_finite"], 2);
  EXPECT_EQ(vectors["left_out_outside_image"], 2);
  EXPECT_EQ(vectors["left_out_displacement_beyond_image"], 1);
  EXPECT_EQ(vectors["left_out_displacement_not_finite"], 1);
  EXPECT_EQ(errors["ray_truth"]["count"].get<int>(), ours_["ray_truth"]["count"].get<int>() - 6);
  // six vectors of over two hundred less: the rms stays within a few per cent
  EXPECT_NEAR(errors["ray_truth"]["rms_px"].get<double>() / ours_["ray_truth"]["rms_px"].get<double>(), 1.0, 0.1);
  Outcome const told = gladstone({"compare", "case", "--no-figures", "--vectors", "some.csv"});
  EXPECT_THAT(told.err,
              testing::HasSubstr("6 of " + std::to_string(x_.size()) + " vectors are left out: 2 with a place"));
  EXPECT_THAT(told.out,
              testing::HasSubstr("left out as well: 2 with a place that is nan or infinite, 2 outside the image"));
}

TEST_F(ForeignVectors, ImpossibleOnesOfOurOwnFilesAreLeftOutToo) {
  succeed({"correlate", "case", "-o", "v.csv"});
  std::string text = read("v.csv");
  auto const line = text.find('\n') + 1;
  text.replace(line, text.find(',', line) - line, "1e15");
  write("v.csv", text);
  auto const errors = compare({"--vectors", "v.csv"});
  EXPECT_EQ(errors["vectors"]["left_out_outside_image"], 1);
  EXPECT_EQ(errors["vectors"]["total"], x_.size());
}

// A thousandth of the wave moves dots by less than tells one choice of axes from another.
TEST_F(ForeignVectors, WhoseConventionsCannotBeToldAreWarnedOf) {
  render("quiet", {"--set", "medium.field.amplitude_kg_m3=1e-4"});
  write_changed("still.csv", [](std::size_t, Vec2d&, Vec2d& displacement) { displacement = {}; });
  Outcome const told = gladstone({"compare", "quiet", "--no-figures", "--vectors", "still.csv"});
  EXPECT_EQ(told.exit_code, 0) << told.err;
  EXPECT_THAT(told.err, testing::HasSubstr("warning: still.csv: "));
  EXPECT_THAT(told.err, testing::HasSubstr("conventions cannot be told"));
}

TEST_F(ForeignVectors, AreRefusedWhereNoneLiesInTheImage) {
  write_changed("far.csv", [](std::size_t, Vec2d& place, Vec2d&) { place = 1000.0 * place; });
  expect_refused({"compare", "case", "--vectors", "far.csv"}, 2,
                 {"far.csv: none of", "lies in the image of 128 x 128 px (x from 7500 to", "px"});
  write_changed("mm.csv", [](std::size_t, Vec2d& place, Vec2d&) { place = 0.01 * place; });
  expect_refused({"compare", "case", "--vectors", "mm.csv"}, 2, {"mm.csv: ", "lie closer than pixels", "not in mm"});
}

TEST_F(ForeignVectors, ThatFitNoConventionAreRefusedUnlessTold) {
  write_changed("exchanged.csv", [](std::size_t, Vec2d& place, Vec2d&) { std::swap(place.x, place.y); });
  expect_refused({"compare", "case", "--vectors", "exchanged.csv"}, 2,
                 {"exchanged.csv: named columns vectors fit no convention", "the truth itself is", "y-up,v-up",
                  "with x and y exchanged they would fit", "--conventions"});
  write_changed("shifted.csv", [](std::size_t, Vec2d& place, Vec2d&) { place += Vec2d{21.0, 0.0}; });
  expect_refused({"compare", "case", "--vectors", "shifted.csv"}, 2, {"fit no convention", "another origin"});
  auto const told = compare({"--vectors", "shifted.csv", "--conventions", "y-down,v-down"});
  EXPECT_GT(told["ray_truth"]["rms_px"].get<double>(), 10 * ours_["ray_truth"]["rms_px"].get<double>());
}

TEST_F(ForeignVectors, HalfAPixelIsReportedWithAndWithout) {
  write_changed("half.csv", [](std::size_t, Vec2d& place, Vec2d&) { place += Vec2d{0.5, 0.5}; });
  auto const errors = compare({"--vectors", "half.csv"});
  nlohmann::json const& fit = errors["vectors"]["fit"];
  EXPECT_EQ(fit["offset_px"], -0.5);
  EXPECT_EQ(fit["verdict"], "fits");
  EXPECT_LT(fit["rms_px"].get<double>(), fit["rms_without_offset_px"].get<double>());
  EXPECT_EQ(fit["tried"].size(), 8u);
  EXPECT_THAT(errors["vectors"]["conventions"].get<std::string>(), testing::HasSubstr("x - 0.5 px fits better: rms "));
  EXPECT_THAT(succeed({"compare", "case", "--no-figures", "--vectors", "half.csv"}),
              testing::HasSubstr("x - 0.5 px fits better: rms "));
}

TEST_F(ForeignVectors, ToldConventionsMustBeWords) {
  expect_refused({"compare", "case", "--conventions", "sideways"}, 2, {"unknown word \"sideways\"", "y-up"});
}

}  // namespace
}  // namespace gladstone::end_to_end
