#include <fmt/format.h>

#include <cmath>
#include <functional>
#include <limits>
#include <tuple>
#include <utility>

#include "render/base/vec.h"
#include "tests/end_to_end/support/program_fixture.h"
#include "tests/support/numbers_in.h"

namespace gladstone::end_to_end {
namespace {

/// The case's own vectors in the formats of other codes: compare must detect the conventions and find the same errors.
class ForeignVectors : public ProgramFixture {
 protected:
  void SetUp() override {
    ProgramFixture::SetUp();
    // A wave, in which a wrong position has an effect: its amplitude is half a pixel, and a position error of half a
    // pixel changes it by some hundredths. Its direction is so close to x that it is not symmetric under an exchange of
    // x and y.
    std::string const wave = with(
        with(small_setup, "[64, 64]", "[128, 128]"), "kind = \"uniform_gradient\"\ngradient_kg_m4 = [20.0, 10.0, 0.0]",
        "kind = \"sinusoid\"\namplitude_kg_m3 = 0.15\nwavelength_mm = 8.0\ndirection = [1, 0.3]");
    write("setup.toml", with(wave, "rays_per_dot = 32", "rays_per_dot = 512"));
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
  // OpenPIV's transform_coordinates: y mirrored about the grid, and v with it; x = ws/2 where ours is (ws - 1)/2
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

// Vectors are scored as their format specifies. Mistakes are reported in the log and by the exit code; with
// --conventions they are read as the user specifies, and have the errors of correct vectors.
TEST_F(ForeignVectors, MistakesAreNamedAndNotForgiven) {
  struct Wrong {
    std::string name, conventions;
    Change change;
  };
  std::vector<Wrong> const all{
      {"flipped.csv", "v-up", [](std::size_t, Vec2d&, Vec2d& d) { d.y = -d.y; }},
      {"frames.csv", "frames-exchanged", [](std::size_t, Vec2d&, Vec2d& d) { d = -d; }},
      {"u_and_v.csv", "components-exchanged", [](std::size_t, Vec2d&, Vec2d& d) { std::swap(d.x, d.y); }},
      {"x_and_y.csv", "places-exchanged", [](std::size_t, Vec2d& p, Vec2d&) { std::swap(p.x, p.y); }},
      {"ten.csv", "px/frame=10",  // times the measurement, which follows 1.02 of the truth
       [](std::size_t, Vec2d&, Vec2d& d) { d = 10.0 * d; }},
  };
  for (Wrong const& wrong : all) {
    write_changed(wrong.name, wrong.change);
    Outcome const outcome =
        gladstone({"compare", "case", "--no-figures", "--quiet", "--json", "--vectors", wrong.name});
    EXPECT_EQ(outcome.exit_code, 1) << wrong.name << outcome.err;
    auto const errors = nlohmann::json::parse(outcome.out);
    EXPECT_EQ(errors["vectors"]["fit"]["verdict"], "mistaken") << wrong.name;
    nlohmann::json const& mistake = errors["vectors"]["fit"]["likely_mistake"];
    EXPECT_THAT(mistake["conventions"].get<std::string>(), testing::HasSubstr(wrong.conventions));
    EXPECT_THAT(errors["vectors"]["conventions"].get<std::string>(),
                testing::HasSubstr(mistake["text"].get<std::string>()));
    EXPECT_GT(errors["ray_truth"]["rms_px"].get<double>(), 3.0 * ours_["ray_truth"]["rms_px"].get<double>())
        << wrong.name;
    EXPECT_THAT(warnings_in(errors), testing::Contains("implausible at " + std::string(wrong.name)));
    expect_same_errors(compare({"--vectors", wrong.name, "--conventions", wrong.conventions}));
  }
}

// Our text format contains no hashes of its frames: exchanged frames are detected by their displacements, for
// vectors.h5 by their hashes.
TEST_F(ForeignVectors, ExchangedFramesOfOurOwnAreNamed) {
  EXPECT_THAT(warnings_in(json_of({"correlate", "case/flow.tif", "case/reference.tif", "-o", "v.csv"})),
              testing::Contains("inconsistent"));
  Outcome const compared = gladstone({"compare", "case", "--no-figures", "--vectors", "v.csv", "--json"});
  EXPECT_EQ(compared.exit_code, 1) << compared.err;
  EXPECT_THAT(warnings_in(nlohmann::json::parse(compared.out)), testing::Contains("implausible at v.csv"));
  gladstone({"correlate", "case/flow.tif", "case/reference.tif", "-o", "v.h5"});
  expect_error({"compare", "case", "--vectors", "v.h5"}, 2, "inconsistent at v.h5");
  std::filesystem::copy_file(in("case/flow.tif"), in("a.tif"));
  std::filesystem::copy_file(in("case/reference.tif"), in("case/b.tif"));
  std::filesystem::rename(in("a.tif"), in("case/a.tif"));
  EXPECT_THAT(warnings_in(json_of({"correlate", "case/a.tif", "case/b.tif", "-o", "v.csv"})),
              testing::Contains("inconsistent"));
}

TEST_F(ForeignVectors, GivenTwiceAreRefused) {
  write_changed("twice.csv", [](std::size_t, Vec2d&, Vec2d&) {});
  write("twice.csv", read("twice.csv") + fmt::format("{},{},0,0\n", x_[0], y_[0]));
  expect_error({"compare", "case", "--vectors", "twice.csv"}, 2, "inconsistent at twice.csv", {"1 of "});
}

// Impossible numbers: each of these vectors is excluded with its reason, and the others are compared as before.
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
  // six of more than two hundred vectors fewer: the rms changes by a few per cent at most
  EXPECT_NEAR(errors["ray_truth"]["rms_px"].get<double>() / ours_["ray_truth"]["rms_px"].get<double>(), 1.0, 0.1);
  expect_warning_in(errors, "excluded at some.csv", {"6 of " + std::to_string(x_.size())});
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

// A thousandth of the wave is too small a displacement to distinguish one choice of axes from another.
TEST_F(ForeignVectors, WhoseConventionsCannotBeToldAreWarnedOf) {
  render("quiet", {"--set", "medium.field.amplitude_kg_m3=1e-4"});
  write_changed("still.csv", [](std::size_t, Vec2d&, Vec2d& displacement) { displacement = {}; });
  EXPECT_THAT(warnings_in(json_of({"compare", "quiet", "--no-figures", "--vectors", "still.csv"})),
              testing::Contains("assumed at still.csv"));
}

TEST_F(ForeignVectors, AreRefusedWhereNoneLiesInTheImage) {
  write_changed("far.csv", [](std::size_t, Vec2d& place, Vec2d&) { place = 1000.0 * place; });
  expect_error({"compare", "case", "--vectors", "far.csv"}, 2, "inconsistent at far.csv", {"128 x 128 px", "7500"});
  write_changed("mm.csv", [](std::size_t, Vec2d& place, Vec2d&) { place = 0.01 * place; });
  expect_error({"compare", "case", "--vectors", "mm.csv"}, 2, "inconsistent at mm.csv", {std::to_string(x_.size())});
}

// Pseudo-random displacements as large as the truth follow it in no reading. A shift of positions by 21 px to the right
// is reported.
TEST_F(ForeignVectors, FittingNoConventionAreRefusedUnlessSpecified) {
  write_changed("random.csv", [](std::size_t i, Vec2d&, Vec2d& d) {
    d = {0.5 * std::sin(1e4 * std::sin(static_cast<double>(i + 1))),
         0.5 * std::cos(1e4 * std::sin(2.0 + static_cast<double>(i)))};
  });
  expect_error({"compare", "case", "--vectors", "random.csv"}, 2, "inconsistent at random.csv",
               {"y-up,v-up", "--conventions"});
  write_changed("shifted.csv", [](std::size_t, Vec2d& place, Vec2d&) { place += Vec2d{21.0, 0.0}; });
  Outcome const shifted = gladstone({"compare", "case", "--no-figures", "--vectors", "shifted.csv", "--json"});
  EXPECT_EQ(shifted.exit_code, 1) << shifted.err;
  auto const errors = nlohmann::json::parse(shifted.out);
  expect_warning_in(errors, "implausible at shifted.csv");
  double const shift = numbers_in(errors["vectors"]["fit"]["likely_mistake"]["text"].get<std::string>()).at(0);
  EXPECT_NEAR(shift, 21, 2) << "a component of the shift is described only if it is known to 2 px";
  auto const told = compare({"--vectors", "shifted.csv", "--conventions", "y-down,v-down"});
  EXPECT_GT(told["ray_truth"]["rms_px"].get<double>(), 10 * ours_["ray_truth"]["rms_px"].get<double>());
}

TEST_F(ForeignVectors, HalfAPixelIsNotForgiven) {
  write_changed("half.csv", [](std::size_t, Vec2d& place, Vec2d&) { place += Vec2d{0.5, 0.5}; });
  Outcome const outcome = gladstone({"compare", "case", "--no-figures", "--json", "--vectors", "half.csv"});
  EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
  expect_warning_in(nlohmann::json::parse(outcome.out), "implausible at half.csv", {"0.5 px"});
  nlohmann::json const fit = nlohmann::json::parse(outcome.out)["vectors"]["fit"];
  EXPECT_EQ(fit["offset_px"], 0.0);
  EXPECT_EQ(fit["likely_mistake"]["conventions"], "y-down,v-down,offset=-0.5");
  EXPECT_LT(fit["likely_mistake"]["rms_without_px"].get<double>(), fit["rms_px"].get<double>());
  EXPECT_EQ(fit["tried"].size(), 32u);
  expect_same_errors(compare({"--vectors", "half.csv", "--conventions", "offset=-0.5"}));
}

TEST_F(ForeignVectors, ToldConventionsMustBeWords) {
  expect_error({"compare", "case", "--conventions", "sideways"}, 2, "arguments at --conventions",
               {"\"sideways\"", "y-up"});
}

/// tests/cases/vectors: one measurement of piv_case.toml as other programs write it.
class OtherPrograms : public ProgramFixture {};

// Against the rays all of them have the errors of the original vectors, 0.040 px rms. The printed values have three
// digits, and the 267 vectors that Insight's file marks as invalid are a ninth of all: their contribution to an rms has
// a standard deviation of the rms / sqrt(2 * 2 * 2134), 0.0004 px.
TEST_F(OtherPrograms, HaveTheErrorsOfTheVectorsTheyComeFrom) {
  std::string const folder = std::string(GLADSTONE_DATA_DIR) + "/../tests/cases/vectors/";
  render("case", {}, folder + "piv_case.toml");
  for (auto const& [name, format, more] :
       {std::tuple<std::string, std::string, std::vector<std::string>>{
            "davis.dat", "DaVis vectors read as y-up-image,v-up", {}},
        {"insight.vec", "Insight vectors read as y-up-image,v-up", {}},
        {"jpiv.jvc", "JPIV vectors read as y-down,v-down", {}},
        {"dantec.csv", "Dantec vectors read as y-up-image,v-up", {}},
        {"semicolon.csv", "named columns vectors read as y-down,v-down", {}},
        {"mm.csv",
         "named columns vectors read as y-down,v-down,offset=0,px=0.0614,px/frame=6.14",
         {"--conventions", "px=0.0614,px/frame=6.14"}}}) {
    std::vector<std::string> arguments{"compare", "case", "--no-figures", "--vectors", folder + name};
    arguments.insert(arguments.end(), more.begin(), more.end());
    auto const errors = json_of(arguments);
    EXPECT_NEAR(errors["ray_truth"]["rms_px"].get<double>(), 0.040, 0.0012) << name;
    EXPECT_THAT(errors["vectors"]["conventions"].get<std::string>(), testing::HasSubstr(format)) << name;
    arguments.emplace_back("--quiet");
    EXPECT_THAT(succeed(arguments), testing::HasSubstr(format)) << "printed with --quiet, too";
  }
  expect_error({"compare", "case", "--vectors", folder + "mm.csv"}, 2, "undetermined at mm.csv",
               {" mm ", " m/s ", "--conventions px=NUMBER,px/frame=NUMBER"});
}

}  // namespace
}  // namespace gladstone::end_to_end
