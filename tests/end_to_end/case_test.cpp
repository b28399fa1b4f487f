#include <cmath>

#include "analysis/errors/error_summary.h"
#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::UnorderedElementsAre;
using testing::UnorderedElementsAreArray;

/// Files of a case, which are equal to the bit if the case is rendered again.
using Case = ProgramFixture;

std::vector<std::string> keys(nlohmann::json const& object) {
  std::vector<std::string> names;
  for (auto const& item : object.items()) names.push_back(item.key());
  return names;
}

TEST_F(Case, RenderCorrelateCompareMakeTheFilesOfTheContract) {
  write("setup.toml", automatic_setup());
  render("case");
  EXPECT_THAT(names("case"),
              UnorderedElementsAre("reference.tif", "flow.tif", "truth.h5", "setup.toml", "summary.json"));
  succeed({"correlate", "case"});
  EXPECT_TRUE(std::filesystem::exists(in("case/vectors.h5")));
  EXPECT_THAT(succeed({"compare", "case", "--no-figures"}), HasSubstr("Error budget"));
  EXPECT_THAT(names("case"), UnorderedElementsAre("reference.tif", "flow.tif", "truth.h5", "setup.toml", "summary.json",
                                                  "vectors.h5", "errors.json", "comparison.h5"));
  EXPECT_THAT(names(), UnorderedElementsAre("case", "setup.toml"));
}

TEST_F(Case, SummaryHasItsKeysAndTheMagnificationOfTheThinLens) {
  write("setup.toml", automatic_setup());
  render("case");
  auto const summary = nlohmann::json::parse(read("case/summary.json"));
  for (char const* key : {"magnification", "step_mm", "rays_per_dot", "exposure", "gladstone_dale", "device", "rays",
                          "warnings", "truth_error_px", "estimator"}) {
    EXPECT_TRUE(summary.contains(key)) << key;
  }
  // f / (Z_B - f) = 105 / 895
  EXPECT_NEAR(summary["magnification"].get<double>(), 105.0 / 895.0, 1e-15);
  EXPECT_EQ(summary["rays_per_dot"], 32);
  EXPECT_EQ(summary["gladstone_dale"], 2.26e-4);
}

TEST_F(Case, FilesTellWholeNumbersAndPitchesAsWritten) {
  render("case");
  EXPECT_THAT(read("case/reference.tif"), HasSubstr("# gladstone image, bit_depth = 16, pixel_pitch_m = 1e-05\n"));
  succeed({"correlate", "case"});
  EXPECT_EQ(Hdf5Reader(in("case/vectors.h5").string()).attribute("grid_columns"), "7");
}

TEST_F(Case, MapsOfTheFieldAreOneNodeEveryTwoPixels) {
  render("case", {"--set", "camera.pixels=[64, 48]"});
  Hdf5Reader const truth(in("case/truth.h5").string());
  EXPECT_EQ(truth.read("/field/spacing_px"), std::vector<double>{2});
  EXPECT_EQ(truth.shape("/field/density_kg_m3"), (std::vector<std::size_t>{24, 32}));
  EXPECT_EQ(truth.shape("/field/eq9_px"), (std::vector<std::size_t>{24, 32, 2}));
}

TEST_F(Case, ErrorsHaveTheirKeysAndTheBudgetAddsUp) {
  write("setup.toml", automatic_setup());
  render("case");
  succeed({"correlate", "case"});
  succeed({"compare", "case", "--no-figures"});
  auto const errors = nlohmann::json::parse(read("case/errors.json"));
  std::vector<std::string> measures;
  for (ErrorMeasure const& measure : all_error_measures())
    if (measure.of_case) measures.emplace_back(measure.name);
  for (char const* truth : {"ray_truth", "eq9", "eq9_cone"}) {
    EXPECT_THAT(keys(errors[truth]), UnorderedElementsAreArray(measures));
    EXPECT_EQ(errors[truth]["count"], errors["ray_truth"]["count"]) << "all comparisons use the same mask";
  }
  auto const& terms = errors["budget"]["terms"];
  EXPECT_THAT(keys(terms), UnorderedElementsAre("small_angle", "cone", "refraction", "aberration", "window",
                                                "estimator", "pattern", "noise"));
  EXPECT_TRUE(terms["pattern"]["rms_px"].is_null()) << "needs repeats";
  // the chain runs from Eq. 9 to the measurement: its biases add up to that of the measurement against Eq. 9
  double sum = 0;
  for (auto const& term : terms) sum += term["bias_u_px"].is_null() ? 0.0 : term["bias_u_px"].get<double>();
  EXPECT_NEAR(sum, errors["eq9"]["bias_u_px"].get<double>(), 1e-9);
  EXPECT_LT(errors["budget"]["closure_px"].get<double>(), 1e-9);
  EXPECT_LT(errors["ray_truth"]["rms_px"].get<double>(), 0.05);
}

// Out of focus, the effect of the lens on a dot is attributed to aberration; the effect of the medium remains the
// refraction seen by an ideal lens in focus, times the magnification: 0.6 % larger with the focus at 950 mm instead of
// 1000 mm, 4 % at 750 mm.
TEST_F(Case, DefocusIsAberrationAndNotRefraction) {
  std::string const few = with(with(automatic_setup(), "rays_per_dot = 32", "rays_per_dot = 4096"),
                               "dots_per_32px_window = 10.0", "dots_per_32px_window = 4.0");
  write("wave.toml", with(few, "kind = \"uniform_gradient\"\ngradient_kg_m4 = [20.0, 10.0, 0.0]",
                          "kind = \"sinusoid\"\namplitude_kg_m3 = 0.05\nwavelength_mm = 4.0"));
  auto const terms = [&](std::string const& folder, std::vector<std::string> const& options) {
    render(folder, options, "wave.toml");
    succeed({"correlate", folder});
    succeed({"compare", folder, "--no-figures"});
    auto const errors = nlohmann::json::parse(read(folder + "/errors.json"));
    EXPECT_LT(errors["budget"]["closure_px"].get<double>(), 1e-9);
    return errors["budget"]["terms"];
  };
  auto const rms = [](nlohmann::json const& of, char const* term) { return of[term]["rms_px"].get<double>(); };
  // in focus the truth is that of a table: it does not depend on the number of rays
  std::string const rays = "render.rays_per_dot=32";
  auto const sharp = terms("sharp", {"--set", rays}),
             named = terms("named", {"--set", rays, "--set", "lens.focus_distance_mm=1000.0"}),
             soft = terms("soft", {"--set", "lens.focus_distance_mm=950.0"}),
             medium = terms("medium", {"--set", "lens.focus=medium"});
  EXPECT_EQ(rms(sharp, "aberration"), 0);
  // A thin lens that is focused on the dots equals the ideal lens. Both trace the same rays, whose positions of up to
  // 64 px have rounding errors of 1e-14 px for each of some thousand operations.
  EXPECT_LT(rms(named, "aberration"), 1e-9);
  EXPECT_GT(rms(sharp, "refraction"), 0.002);
  // The rays of a blurred dot scatter: 4096 of them change its refraction by 0.5 %, 1024 by 20 %.
  for (auto const& blurred : {soft, medium}) {
    EXPECT_NEAR(rms(blurred, "refraction") / rms(sharp, "refraction"), 1, 0.05);
    EXPECT_GT(rms(blurred, "aberration"), 5 * rms(blurred, "refraction"));
  }
}

TEST_F(Case, VectorsAsTextHaveTheColumnsOfTheContract) {
  render("case");
  succeed({"correlate", "case", "-o", "v.csv"});
  std::string const text = read("v.csv");
  EXPECT_EQ(
      text.substr(0, text.find('\n')),
      "x_px,y_px,u_px,v_px,sigma_u_px,sigma_v_px,peak_ratio,status,u_raw_px,v_raw_px,correlation,reason,ambiguous");
  EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1 + 49);  // 16 px windows every 8 px: 7 x 7
  EXPECT_THAT(text, HasSubstr("\n7.5,7.5,"));                     // (ws - 1)/2 from the first pixel
  // two images with the same settings give the same vectors
  succeed({"correlate", "case/reference.tif", "case/flow.tif", "-o", "w.csv", "--set", "correlate.window_px=[32,16]",
           "--set", "correlate.overlap=0.5"});
  EXPECT_EQ(read("w.csv"), text);
  write("c.toml", "[correlate]\nwindow_px = [32, 16]\noverlap = 0.5\n");
  succeed({"correlate", "case/reference.tif", "case/flow.tif", "-o", "x.csv", "--config", "c.toml"});
  EXPECT_EQ(read("x.csv"), text);
  // a complete setup is accepted, resolved or not; its other tables are ignored
  succeed({"correlate", "case/reference.tif", "case/flow.tif", "-o", "y.csv", "--config", "case/setup.toml"});
  EXPECT_EQ(read("y.csv"), text);
  write("s.toml", with(small_setup, "f_number = 11.0", "f_number = 0.0"));
  succeed({"correlate", "case", "-o", "z.csv", "--config", "s.toml"});
  EXPECT_EQ(read("z.csv"), text);
  write("s.toml", "[corelate]\nwindow_px = [32, 16]\n");
  expect_error({"correlate", "case", "--config", "s.toml"}, 2, "unknown_key at s.toml:1:2", {"[corelate]"});
}

TEST_F(Case, ComparisonsCanBeWrittenApart) {
  namespace fs = std::filesystem;
  render("case");
  succeed({"correlate", "case"});
  succeed({"compare", "case"});
  std::string const beside = read("case/errors.json");
  fs::remove(in("case/errors.json"));
  for (std::string const again : {"results/of one", "results/of one/"}) {
    succeed({"compare", "case", "-o", again});
    EXPECT_EQ(read("results/of one/errors.json"), beside);
    EXPECT_TRUE(fs::exists(in("results/of one/error_budget.png")));
  }
  EXPECT_FALSE(fs::exists(in("case/errors.json"))) << "the case is unchanged";
  succeed({"compare", "case", "--no-figures", "-o", "results/of one"});
  EXPECT_FALSE(fs::exists(in("results/of one/error_budget.png"))) << "figures of the earlier comparison are removed";
  succeed({"compare", "case", "-o", "case/"});
  EXPECT_EQ(read("case/errors.json"), beside);
  EXPECT_TRUE(fs::exists(in("case/vectors.h5")));
  EXPECT_TRUE(fs::exists(in("case/error_budget.png")));
  expect_error({"compare", "case", "-o", "setup.toml"}, 2, "output at setup.toml");
  fs::create_directory(in("mine"));
  write("mine/notes.txt", "notes");
  expect_error({"compare", "case", "-o", "mine"}, 2, "output at mine");
  EXPECT_EQ(read("mine/notes.txt"), "notes");
  render("case");
  EXPECT_THAT(names("case"),
              UnorderedElementsAre("reference.tif", "flow.tif", "truth.h5", "setup.toml", "summary.json"))
      << "every figure is in case_file::derived";
}

TEST_F(Case, ColourPicturesAreSaidToBeTurnedToGrey) {
  std::string picture = "P6\n64 64\n255\n";
  for (unsigned i = 0; i < 3 * 64 * 64; ++i) picture += static_cast<char>(i * 2654435761u >> 24);
  write("colour.ppm", picture);
  auto const json =
      json_of({"correlate", "colour.ppm", "colour.ppm", "-o", "v.csv", "--set", "correlate.window_px=[16]"});
  EXPECT_THAT(warnings_in(json), testing::Contains("assumed at colour.ppm"));
  EXPECT_EQ(json_of({"info", "image", "colour.ppm"})["channels"], 3);
}

TEST_F(Case, SetOfACorrelationChangesTheCasesOwnSettings) {
  render("case");
  EXPECT_EQ(json_of({"correlate", "case"})["vectors"], 49);  // 16 px windows every 8 px: 7 x 7
  EXPECT_EQ(json_of({"correlate", "case", "--set", "correlate.overlap=0"})["vectors"], 16);  // every 16 px
  expect_error({"correlate", "case", "--set", "lens.f_number=8"}, 2, "unknown_key at --set lens.f_number=8",
               {"correlate."});
}

// Each valid vector has a sigma, which the comparison verifies; both components of the vectors count.
TEST_F(Case, UncertaintiesAreWrittenAndJudged) {
  render("case");
  EXPECT_THAT(succeed({"correlate", "case", "--device", "cpu"}), testing::ContainsRegex(" masked +0\n"));
  EXPECT_THAT(succeed({"compare", "case", "--no-figures"}), HasSubstr("standard uncertainties: "));
  auto const quality = nlohmann::json::parse(read("case/errors.json"))["uncertainty"];
  for (char const* truth : {"window_truth", "deformed_window_truth", "ray_truth"}) {
    EXPECT_GT(quality[truth]["count"], 2 * 40);
    EXPECT_LE(quality[truth]["count"], 2 * 49);
    EXPECT_GE(quality[truth]["coverage_2"], quality[truth]["coverage_1"]);
    EXPECT_GT(quality[truth]["rms_ratio"], 0.0);
  }
  succeed({"correlate", "case", "--set", "correlate.uncertainty=none"});
  EXPECT_THAT(succeed({"compare", "case", "--no-figures"}), Not(HasSubstr("standard uncertainties")));
  EXPECT_FALSE(nlohmann::json::parse(read("case/errors.json")).contains("uncertainty"));
}

// On a CPU the default is correlation statistics; the estimate does not change the vectors. A single pass, whose
// estimate is not valid, has none.
TEST_F(Case, UncertaintyIsEstimatedByDefaultWithoutEffectOnTheVectors) {
  render("case");
  auto const vectors = [&](std::string const& setting) {
    succeed({"correlate", "case", "--device", "cpu", "-o", "v.h5", "--set", setting});
    Hdf5Reader const file(in("v.h5").string());
    return std::array{file.read("/u_px"), file.read("/v_px"), file.read("/sigma_u_px")};
  };
  auto const finite = [](std::vector<double> const& values) {
    return std::count_if(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
  };
  auto const by_default = vectors("correlate.overlap=0.5"),
             with = vectors("correlate.uncertainty=correlation_statistics"),
             without = vectors("correlate.uncertainty=none");
  EXPECT_GT(finite(by_default[2]), 40);
  EXPECT_EQ(by_default[2], with[2]);
  EXPECT_EQ(finite(without[2]), 0);
  for (int component : {0, 1}) EXPECT_EQ(by_default[component], without[component]);
  EXPECT_EQ(finite(vectors("correlate.window_px=[16]")[2]), 0);
}

TEST_F(Case, SetOnTheCommandLineEqualsTheSameInTheFile) {
  write("changed.toml",
        with(with(small_setup, "f_number = 11.0", "f_number = 8.0"), "[20.0, 10.0, 0.0]", "[-30.0, 0.0, 5.0]"));
  render("file", {}, "changed.toml");
  render("set", {"--set", "lens.f_number=8", "--set", "medium.field.gradient_kg_m4=[-30.0, 0.0, 5.0]"});
  expect_same_case("file", "set");
  EXPECT_EQ(read("file/setup.toml"), read("set/setup.toml"));
}

TEST_F(Case, TheResolvedSetupRendersTheSameBitsAgain) {
  write("auto.toml", with(with(automatic_setup(), "rays_per_dot = 32", "rays_per_dot = \"auto\""), "[camera]",
                          "[camera]\nexposure = \"auto\"\nnoise = { read_noise_e = 5.0 }"));
  render("first", {}, "auto.toml");
  std::string const resolved = read("first/setup.toml");
  // values chosen for each dot remain "auto", and so does the exposure for which they are chosen
  EXPECT_THAT(resolved, AllOf(HasSubstr("\nrays_per_dot = \"auto\"\n"), HasSubstr("\nexposure = \"auto\"\n"),
                              Not(HasSubstr("step_mm = \"auto\"")), Not(HasSubstr("method = \"auto\""))));
  render("second", {}, "first/setup.toml");
  expect_same_case("first", "second");
  EXPECT_EQ(read("second/setup.toml"), resolved);
}

// If the setup does not give the extent of the target, it depends on the window of the first pass; the rendered extent
// is stored.
TEST_F(Case, TheResolvedSetupKeepsItsDotsWithAnotherWindow) {
  render("first");
  EXPECT_THAT(read("first/setup.toml"), AllOf(HasSubstr("\nextent_mm = ["), HasSubstr("\nrays_per_dot = 32\n")));
  render("second", {"--set", "correlate.window_px=[16]"}, "first/setup.toml");
  expect_same_case("first", "second");
}

TEST_F(Case, SummaryTellsTheSpotThatWasDrawn) {
  // The lens of Table 1: 2.44 N (1 + M) lambda = 1.595 px, pi times as much as printed in the paper; the PSF is drawn
  // with a quarter of it
  render("first", {"--set", "lens.psf=seed_eq8"});
  auto const spot = nlohmann::json::parse(read("first/summary.json"))["spot"];
  EXPECT_NEAR(spot["first_zero_diameter_px"].get<double>(), 5.01, 5e-3);
  EXPECT_NEAR(spot["sigma_px"].get<double>(), 5.01 / 4, 2e-3);
  render("second", {"--set", "lens.psf=none"});
  EXPECT_EQ(nlohmann::json::parse(read("second/summary.json"))["spot"]["first_zero_diameter_px"], 0);
}

TEST_F(Case, OneTwoAndSevenThreadsGiveTheSameBits) {
  write("setup.toml", automatic_setup());
  for (std::string const threads : {"1", "2", "7"}) {
    render("case" + threads, {"--threads", threads});
    succeed({"correlate", "case" + threads, "--threads", threads});
    succeed({"compare", "case" + threads, "--threads", threads, "--no-figures"});
    if (threads == "1") continue;
    expect_same_case("case1", "case" + threads);
    expect_same_datasets("case1/vectors.h5", "case" + threads + "/vectors.h5");
    EXPECT_EQ(read("case1/errors.json"), read("case" + threads + "/errors.json"));
  }
}

TEST_F(Case, RenderingTwiceGivesTheSame) {
  write("setup.toml", automatic_setup());
  render("a");
  render("b");
  expect_same_case("a", "b");
  EXPECT_EQ(read("a/setup.toml"), read("b/setup.toml"));
}

TEST_F(Case, AnotherSeedOfTheTargetGivesOtherDots) {
  render("a");
  render("b", {"--set", "target.seed=8"});
  EXPECT_NE(Hdf5Reader(in("a/truth.h5").string()).read("/dots/position_m"),
            Hdf5Reader(in("b/truth.h5").string()).read("/dots/position_m"));
}

TEST_F(Case, FileNamesStartAtTheSetupWhereverTheProgramRuns) {
  std::filesystem::create_directories(in("Versuch Nr. 1 – Wärme/daten"));
  std::filesystem::create_directories(in("elsewhere"));
  write("Versuch Nr. 1 – Wärme/daten/punkte.csv", "x_mm,y_mm\n0,0\n1,0.5\n-1,0.25\n");
  write("Versuch Nr. 1 – Wärme/größe.toml",
        with(small_setup, "dots_per_32px_window = 10.0", "kind = \"points\"\nfile = \"daten/punkte.csv\""));
  Outcome const outcome =
      run({"render", "../Versuch Nr. 1 – Wärme/größe.toml", "-o", "../Versuch Nr. 1 – Wärme/fall ä"}, in("elsewhere"));
  ASSERT_EQ(outcome.exit_code, 0) << outcome.err;
  std::string const made = "Versuch Nr. 1 – Wärme/fall ä";
  EXPECT_EQ(Hdf5Reader(in(made + "/truth.h5").string()).shape("/dots/position_m"), (std::vector<std::size_t>{3, 3}));
  succeed({"correlate", made});
  succeed({"compare", made});
  // the setup of the case finds the file from its new folder
  render("again", {}, made + "/setup.toml");
  expect_same_case(made, "again");
}

}  // namespace
}  // namespace gladstone::end_to_end
