#include "studies/sweep/study_file.h"

#include <algorithm>
#include <cmath>
#include <set>

#include "tests/studies/support/study_folder.h"

namespace gladstone {
namespace {

using testing::ElementsAre;

class Studies : public StudyFolder {
 protected:
  /// Values of an axis in the order of the cases.
  static std::vector<std::string> labels(std::vector<ManifestCase> const& cases, std::size_t axis) {
    std::vector<std::string> found;
    for (ManifestCase const& one : cases) found.push_back(one.parameters.at(axis).second.label);
    return found;
  }
  static std::vector<double> numbers(AxisPlan const& axis) {
    std::vector<double> found;
    for (std::size_t i = 0; i < axis.size(); ++i) found.push_back(axis.value(i).parameter.number.value());
    return found;
  }
};

TEST_F(Studies, RangesHaveTheirEndsAndTheStepsThatAreWritten) {
  StudyFile const study = this->study(R"(base = "base.toml"
[axes]
"lens.f_number" = { log = [4, 32, 7] }
"geometry.z_d_mm" = { linear = [100, 1000, 10] }
"lens.focal_length_mm" = { linear = [0.1, 0.3, 3] }
"geometry.z_a_mm" = { log = [1, 1000, 4] }
)");
  // 4 2^(i/2), to twelve digits
  EXPECT_THAT(numbers(study.axes.at(0)), ElementsAre(4, 5.65685424949, 8, 11.313708499, 16, 22.627416998, 32));
  EXPECT_THAT(numbers(study.axes.at(1)), ElementsAre(100, 200, 300, 400, 500, 600, 700, 800, 900, 1000));
  EXPECT_THAT(numbers(study.axes.at(2)), ElementsAre(0.1, 0.2, 0.3));
  EXPECT_THAT(numbers(study.axes.at(3)), ElementsAre(1, 10, 100, 1000));
}

TEST_F(Studies, AGridTakesEveryCombinationWithTheLastAxisFastest) {
  auto const cases = plan(R"(base = "base.toml"
[axes]
"lens.f_number" = [8, 11]
"camera.bit_depth" = [8, 12, 16]
)");
  EXPECT_THAT(labels(cases, 0), ElementsAre("8", "8", "8", "11", "11", "11"));
  EXPECT_THAT(labels(cases, 1), ElementsAre("8", "12", "16", "8", "12", "16"));
  EXPECT_EQ(cases[4].parameters[0].first, "lens.f_number");
  EXPECT_EQ(cases[4].title(), "case 4 (lens.f_number = 11, camera.bit_depth = 12)");
}

TEST_F(Studies, AZipTakesValuesSideBySide) {
  auto const cases = plan(R"(base = "base.toml"
[axes]
"lens.f_number" = [8, 11]
"camera.bit_depth" = { linear = [8, 12, 2] }
[study]
mode = "zip"
repeats = 2
)");
  EXPECT_THAT(labels(cases, 0), ElementsAre("8", "11", "8", "11"));
  EXPECT_THAT(labels(cases, 1), ElementsAre("8", "12", "8", "12"));
}

TEST_F(Studies, AZipMayHaveAValueOfAnAxisAgainWithAnotherOne) {
  auto const cases = plan(R"(base = "base.toml"
[axes]
"lens.f_number" = [{ label = "open", value = 4 }, 8, { label = "open", value = 4 }]
"camera.bit_depth" = [8, 8, 12]
[study]
mode = "zip"
)");
  EXPECT_THAT(labels(cases, 0), ElementsAre("open", "8", "open"));
  EXPECT_THAT(labels(cases, 1), ElementsAre("8", "8", "12"));
}

// 16 points of a scrambled Sobol sequence: each sixteenth of each axis contains exactly one (a (0, 4, s)-net), and each
// of two list values occurs in half of them.
TEST_F(Studies, SobolSamplesFillRangesEvenly) {
  auto const cases = plan(R"(base = "base.toml"
[axes]
"lens.f_number" = { log = [4, 64, 2] }
"geometry.z_d_mm" = { linear = [100, 900, 2] }
"lens.psf" = ["airy", "gaussian"]
[study]
mode = "sobol"
samples = 16
)");
  ASSERT_EQ(cases.size(), 16u);
  std::set<int> along_log, along_linear;
  int airy = 0;
  for (ManifestCase const& one : cases) {
    along_log.insert(static_cast<int>(16 * std::log2(*one.parameters[0].second.number / 4) / 4));
    along_linear.insert(static_cast<int>((*one.parameters[1].second.number - 100) / 50));
    airy += one.parameters[2].second.label == "airy";
  }
  EXPECT_EQ(along_log.size(), 16u);
  EXPECT_EQ(*along_log.rbegin(), 15);
  EXPECT_EQ(along_linear.size(), 16u);
  EXPECT_EQ(*along_linear.rbegin(), 15);
  EXPECT_EQ(airy, 8);
}

TEST_F(Studies, ValuesMayBeTablesAndTextsAndLists) {
  auto const cases = plan(R"(base = "base.toml"
[axes]
"medium.field" = [
  { label = "plume", kind = "gaussian_plume", amplitude_kg_m3 = -0.1, radius_mm = 2.0 },
  { label = "nothing", kind = "none" },
]
"correlate.window_px" = [[32, 16], { label = "one pass", value = [16] }]
"lens.f_number" = [inf]
)");
  EXPECT_THAT(labels(cases, 0), ElementsAre("plume", "plume", "nothing", "nothing"));
  EXPECT_THAT(labels(cases, 1), ElementsAre("[32, 16]", "one pass", "[32, 16]", "one pass"));
  EXPECT_THAT(cases[3].setup, testing::HasSubstr("window_px = [16]"));
  EXPECT_THAT(cases[1].setup, testing::HasSubstr("radius_mm = 2.0"));
  EXPECT_THAT(cases[1].setup, testing::Not(testing::HasSubstr("label")));
  EXPECT_TRUE(std::isinf(*cases[0].parameters[2].second.number));
}

TEST_F(Studies, FilesAreFoundFromTheFileThatNamesThem) {
  std::filesystem::create_directories(in("here"));
  std::filesystem::create_directories(in("there"));
  write("there/base.toml", std::string(small_base) + "[target.nothing]\n");
  write("there/dots.csv", "x_mm,y_mm\n0,0\n");
  write("here/dots.csv", "x_mm,y_mm\n1,1\n");
  std::string base = small_base;
  base.replace(base.find("dots_per_32px_window = 10.0"), 27, "kind = \"points\"\nfile = \"dots.csv\"");
  write("there/base.toml", base);
  write("here/study.toml", R"(base = "../there/base.toml"
[axes]
"lens.f_number" = [11]
)");
  auto const from_base = plan_study(read_study(in("here/study.toml")), "cpu");
  ASSERT_EQ(from_base[0].inputs.size(), 1u);
  EXPECT_EQ(from_base[0].inputs.begin()->first, in("there/dots.csv"));
  EXPECT_THAT(from_base[0].setup, testing::HasSubstr(in("there/dots.csv")));
  write("here/study.toml", R"(base = "../there/base.toml"
[axes]
"target.file" = ["dots.csv"]
)");
  auto const from_study = plan_study(read_study(in("here/study.toml")), "cpu");
  EXPECT_EQ(from_study[0].inputs.begin()->first, in("here/dots.csv"));
  EXPECT_EQ(from_study[0].parameters[0].second.label, "dots.csv");
  EXPECT_NE(from_study[0].inputs.begin()->second, from_base[0].inputs.begin()->second);
}

TEST_F(Studies, SeedsDependOnTheStudyAndTheRepeatAlone) {
  write("base.toml", std::string(small_base) + "[camera.noise]\nread_noise_e = 5.0\n");
  std::string const text = R"(base = "base.toml"
[axes]
"lens.f_number" = [8, 11]
[study]
repeats = 3
seed = 5
)";
  auto const cases = plan(text);
  ASSERT_EQ(cases.size(), 6u);
  std::set<std::uint64_t> seeds;
  for (ManifestCase const& one : cases) seeds.insert(one.seed);
  EXPECT_EQ(seeds.size(), 3u);
  EXPECT_EQ(cases[0].seed, 5u);
  for (std::size_t repeat = 0; repeat < 3; ++repeat) {
    EXPECT_EQ(cases[2 * repeat].seed, cases[2 * repeat + 1].seed);
    std::string const line = "seed = " + std::to_string(cases[2 * repeat].seed);
    std::string const& setup = cases[2 * repeat].setup;
    std::size_t count = 0;  // seeds of dots, rays and noise
    for (std::size_t at = setup.find(line); at != std::string::npos; at = setup.find(line, at + 1)) ++count;
    EXPECT_EQ(count, 3u) << setup;
  }
  EXPECT_EQ(plan(text)[5].line_hash, plan(text)[5].line_hash);
}

TEST_F(Studies, WithoutNoiseASeedDoesNotSwitchItOn) {
  EXPECT_THAT(plan("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = [8]\n")[0].setup,
              testing::Not(testing::HasSubstr("noise")));
}

TEST_F(Studies, AnAxisMayBeASeed) {
  auto const cases = plan("base = \"base.toml\"\n[axes]\n\"target.seed\" = [3, 4]\n");
  EXPECT_THAT(cases[1].setup, testing::HasSubstr("seed = 4"));
}

// The first value of each table has no seed and receives that of the repeat, like the base's tables; the seed of the
// second one is retained.
TEST_F(Studies, TablesAsValuesTakeTheSeedOfTheRepeatUnlessTheyHaveOne) {
  write("base.toml", std::string(small_base) + "[camera.noise]\nread_noise_e = 3.0\n");
  auto const count = [](std::string const& text, std::string const& wanted) {
    std::size_t found = 0;
    for (std::size_t at = text.find(wanted); at != std::string::npos; at = text.find(wanted, at + 1)) ++found;
    return found;
  };
  for (auto const& [key, content] :
       {std::pair{"target", "dots_per_32px_window = 5.0"}, std::pair{"render", "rays_per_dot = 16"},
        std::pair{"camera.noise", "read_noise_e = 2.0"},
        std::pair{"camera", "pixels = [64, 64], noise = { read_noise_e = 1.0 }"}}) {
    std::string inner = content;
    std::string seeded =
        inner.ends_with('}') ? inner.substr(0, inner.size() - 2) + ", seed = 77 }" : inner + ", seed = 77";
    auto const cases = plan("base = \"base.toml\"\n[axes]\n\"" + std::string(key) + "\" = [{ label = \"a\", " + inner +
                            " }, { label = \"b\", " + seeded + " }]\n[study]\nrepeats = 2\nseed = 5\n");
    ASSERT_EQ(cases.size(), 4u);
    for (std::size_t i = 0; i < 4; ++i) {
      std::string const& setup = cases[i].setup;
      EXPECT_EQ(count(setup, "seed = " + std::to_string(cases[i].seed) + "\n"), i % 2 == 0 ? 3u : 2u) << setup;
      EXPECT_EQ(count(setup, "seed = 77\n"), i % 2) << setup;
    }
    EXPECT_NE(cases[0].seed, cases[2].seed);
  }
}

// A million cases in 30 s on two cores are 60 us per case on one core. Ten times that is allowed, for slower machines
// and sanitizers; creating each case from its text, parsing and storing it took 360 us and 17 kB.
TEST_F(Studies, ManyCasesArePlannedInATimeThatGrowsWithTheirNumber) {
  StudyFile const file = study(R"(base = "base.toml"
[axes]
"lens.f_number" = { linear = [8, 16, 200] }
"geometry.z_d_mm" = { linear = [200, 300, 100] }
)");
  std::clock_t const start = std::clock();  // processor time, which other programs do not affect
  StudyPlan const plan = plan_study(file, "cpu");
  EXPECT_EQ(write_plan(in("run"), plan), PlanOutcome::fresh);
  EXPECT_LT(static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC, 20000 * 600e-6);
  Manifest const manifest = read_manifest(in("run"));
  ASSERT_EQ(manifest.size(), 20000u);
  for (std::size_t const index : {0, 4095, 4096, 19999}) {
    EXPECT_EQ(manifest_line(manifest[index]), plan.line(index));
    EXPECT_EQ(manifest[index].line_hash, plan[index].line_hash);
  }
  EXPECT_EQ(write_plan(in("run"), plan), PlanOutcome::unchanged);
}

// 5000 of 6000 values are tried: the ends, and evenly spaced ones between them.
TEST_F(Studies, OfVeryManyValuesTheEndsAreTried) {
  EXPECT_THAT(complaint("base = \"base.toml\"\n[axes]\n\"camera.bit_depth\" = { linear = [1, 17, 6000] }\n"),
              testing::StartsWith("wrong_type at study.toml:3:1, "));
  EXPECT_THAT(complaint("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = { linear = [8, -1, 6000] }\n"),
              testing::StartsWith("invalid_value at study.toml:3:1, "));
}

TEST_F(Studies, NumbersKeepTheirLabels) {
  auto cases = plan("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = [{ label = \"open\", value = 8 }, 16]\n");
  EXPECT_THAT(labels(cases, 0), ElementsAre("open", "16"));
  EXPECT_EQ(cases[0].parameters[0].second.number, 8.0);
  EXPECT_EQ(cases[0].title(), "case 0 (lens.f_number = open)");
}

class BadStudies : public StudyFolder {};

TEST_F(BadStudies, UnknownAxisNamesTheNearestKey) {
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n\"lens.f_numer\" = [8, 11]\n"), "unknown_key at study.toml:3:1");
}

TEST_F(BadStudies, EveryBadValueOfAnAxisIsToldAtItsOwnPlace) {
  EXPECT_EQ(complaint(R"(base = "base.toml"
[axes]
"lens.f_number" = [8, -1, 11]
"camera.bit_depth" = [8,
  12.5]
)"),
            "out_of_range at study.toml:3:23, wrong_type at study.toml:5:3");
}

TEST_F(BadStudies, AnAxisOfTheWrongType) {
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = [\"wide\"]\n"),
            "wrong_type at study.toml:3:20");
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = 8\n"), "invalid_value at study.toml:3:1");
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = { lin = [1, 2, 3] }\n"),
            "invalid_value at study.toml:3:1");
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = { logarithmic = [1, 2, 3] }\n"),
            "invalid_value at study.toml:3:1");
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\nlens.f_number = [1, 2]\n"), "invalid_value at study.toml:3:1");
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = { log = [0, 8, 3] }\n"),
            "invalid_value at study.toml:3:21");
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = { linear = [4, 8] }\n"),
            "invalid_value at study.toml:3:21");
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n\"medium.field\" = [{ kind = \"none\" }]\n"),
            "invalid_value at study.toml:3:19");
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n\"camera.pixels.x\" = [1]\n"), "wrong_type at study.toml:3:22");
}

TEST_F(BadStudies, EmptyAxes) {
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = []\n"), "invalid_value at study.toml:3:1");
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n"), "invalid_value at study.toml:2:2");
  EXPECT_EQ(complaint("base = \"base.toml\"\n"), "missing_key at study.toml:1:1");
}

TEST_F(BadStudies, AThousandMillionCasesAreRefusedByTheirCountAtOnce) {
  EXPECT_EQ(complaint(R"(base = "base.toml"
[axes]
"lens.f_number" = { linear = [4, 32, 1000] }
"geometry.z_d_mm" = { linear = [100, 1000, 1000] }
"geometry.z_a_mm" = { linear = [500, 1000, 1000] }
)"),
            "invalid_value at study.toml:2:2");
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = { linear = [4, 32, 1000000000] }\n"),
            "invalid_value at study.toml:2:2");
}

TEST_F(BadStudies, SettingsThatDoNotFit) {
  std::string const axes = "base = \"base.toml\"\n[axes]\n\"lens.f_number\" = [8, 11]\n";
  EXPECT_EQ(complaint(axes + "[study]\nmode = \"sobl\"\n"), "unknown_choice at study.toml:5:1");
  EXPECT_EQ(complaint(axes + "[study]\nsamples = 4\n"), "invalid_value at study.toml:5:1");
  EXPECT_EQ(complaint(axes + "[study]\nmode = \"sobol\"\n"), "missing_key at study.toml:4:2");
  EXPECT_EQ(complaint(axes + "[study]\nrepeats = 0\n"), "out_of_range at study.toml:5:1");
  EXPECT_EQ(complaint(axes + "[study]\nrepeat = 2\n"), "unknown_key at study.toml:5:1");
  EXPECT_EQ(complaint(axes + "\"lens.focal_length_mm\" = [50]\n[study]\nmode = \"zip\"\n"),
            "invalid_value at study.toml:4:1");
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = [8, 8.0]\n"),
            "invalid_value at study.toml:3:23");
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = [{ label = \"a\", value = 8 },\n  { label = "
                      "\"b\", value = "
                      "8.0 }]\n"),
            "invalid_value at study.toml:4:3");
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = [{ label = \"a\", value = 8 },\n  { label = "
                      "\"a\", value = "
                      "9 }]\n"),
            "invalid_value at study.toml:4:3");
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n\"medium.field\" = [{ label = \"a\", kind = \"none\" },\n  { "
                      "label = \"b\", kind "
                      "= \"none\" }]\n"),
            "invalid_value at study.toml:4:3");
  EXPECT_EQ(complaint("base = \"bas.toml\"\n[axes]\n\"lens.f_number\" = [8]\n"), "missing_file at study.toml:1:1");
}

TEST_F(BadStudies, AZipWithAPointTwice) {
  std::string const axes = "base = \"base.toml\"\n[axes]\n\"lens.f_number\" = ";
  std::string const zip = "\n\"camera.bit_depth\" = [8, 12, 8]\n[study]\nmode = \"zip\"\n";
  EXPECT_EQ(complaint(axes + "[4, 8, 4]" + zip), "invalid_value at study.toml:3:26");
  EXPECT_EQ(complaint(axes + "[4, 8, { label = \"open\", value = 4 }]" + zip), "invalid_value at study.toml:3:26");
  EXPECT_EQ(complaint(axes + "[{ label = \"a\", value = 4 }, 8, { label = \"a\", value = 5 }]" + zip),
            "invalid_value at study.toml:3:51");
}

// 8 and 16 are integers; the values between them are not.
TEST_F(BadStudies, SobolSamplesOfAWholeNumber) {
  std::string const study = "base = \"base.toml\"\n[axes]\n\"camera.bit_depth\" = ";
  std::string const sobol = "\n[study]\nmode = \"sobol\"\nsamples = 4\n";
  EXPECT_EQ(complaint(study + "{ linear = [8, 16, 3] }" + sobol), "wrong_type at study.toml:3:1");
  EXPECT_EQ(complaint(study + "[8, 12, 16]" + sobol), "");
  EXPECT_EQ(complaint(study + "{ linear = [8, 16, 3] }\n"), "");
}

TEST_F(BadStudies, ManyBadValuesAreCountedAndTheFirstTold) {
  std::string values;
  for (int i = 1; i <= 1000; ++i) values += std::to_string(-i) + ", ";
  try {
    plan("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = [" + values + "]\n");
    ADD_FAILURE() << "planned";
  } catch (SetupError const& error) {
    EXPECT_EQ(error.problems().size(), 1000u);
    std::string const text = error.what();
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), max_reported_problems) << "and the number of the others";
  }
}

TEST_F(BadStudies, KeysOfVeryManyPartsAndVeryManyAxes) {
  std::string key = "lens";
  for (int i = 0; i < 100000; ++i) key += ".lens";
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n\"" + key + "\" = [1]\n"), "invalid_value at study.toml:3:1");
  std::string axes;
  for (int i = 0; i < 101; ++i) axes += "\"lens.key" + std::to_string(i) + "\" = [1]\n";
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n" + axes), "invalid_value at study.toml:2:2");
}

TEST_F(BadStudies, AnAxisWithinAnother) {
  for (std::string const mode : {"grid", "zip"}) {
    EXPECT_EQ(
        complaint(
            "base = \"base.toml\"\n[axes]\n\"medium.field.gradient_kg_m4\" = [[1.0, 0.0, 0.0]]\n\"medium.field\" = [{ "
            "label "
            "= \"a\", kind = \"none\" }]\n[study]\nmode = \"" +
            mode + "\"\n"),
        "invalid_value at study.toml:3:1");
  }
  // the same letters are not the same steps
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n\"target.dot_diameter_px\" = "
                      "[3.0]\n\"target.dots_per_32px_window\" = [5.0]\n"),
            "");
}

TEST_F(BadStudies, ARangeWithStepsOfNothing) {
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n\"lens.f_number\" = { linear = [8, 8.00000000001, 30] }\n"),
            "invalid_value at study.toml:3:1");
}

TEST_F(BadStudies, MistakesOfTheBaseAreToldAtItsOwnLines) {
  write("base.toml", "schema = 1\n[lens]\nf_numer = 8\n");
  EXPECT_EQ(complaint("base = \"base.toml\"\n[axes]\n\"geometry.z_d_mm\" = [100, 200]\n"),
            "unknown_key at base.toml:3:1");
}

}  // namespace
}  // namespace gladstone
