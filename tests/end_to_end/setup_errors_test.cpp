#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

/// Invalid setups: exit code 2, place, problem and remedy, and no case folder.
class SetupErrors : public ProgramFixture {
 protected:
  /// Expects the small setup with `old` replaced to be rejected at the place of `at`, with this code.
  /// @param values  names and numbers that the message contains
  void refused(std::string const& old, std::string const& replacement, std::string const& at, std::string const& code,
               std::vector<std::string> const& values = {}) {
    std::string const text = with(small_setup, old, replacement);
    expect_setup_error(text, code + " at setup.toml:" + place_of(text, at), values);
  }
};

// For people, stderr has one line per problem, which begins with its place, and stdout is empty.
TEST_F(SetupErrors, TextBeginsWithThePlace) {
  std::string const text = with(small_setup, "f_number", "fnumber");
  write("wrong.toml", text);
  Outcome const wrong = gladstone({"render", "wrong.toml", "-o", "case"});
  EXPECT_EQ(wrong.out, "");
  EXPECT_THAT(wrong.err, testing::StartsWith("wrong.toml:" + place_of(text, "fnumber") + ": "));
  EXPECT_EQ(std::count(wrong.err.begin(), wrong.err.end(), '\n'), 1);
  Outcome const missing = gladstone({"render", "nowhere.toml", "-o", "case"});
  EXPECT_EQ(missing.out, "");
  EXPECT_THAT(missing.err, testing::StartsWith("nowhere.toml: "));
}

TEST_F(SetupErrors, MisspeltKeyNamesTheNearest) {
  refused("f_number", "fnumber", "fnumber", "unknown_key", {"\"fnumber\"", "[lens]", "\"f_number\""});
}

TEST_F(SetupErrors, MisspeltTableNamesTheNearest) {
  refused("[lens]", "[lense]", "lense", "unknown_key", {"[lense]", "[lens]"});
}

// One problem instead of one for each key of the study.
TEST_F(SetupErrors, StudyInPlaceOfASetupIsNamed) {
  write("study.toml", "base = \"setup.toml\"\n\n[axes]\n\"lens.f_number\" = [8, 16]\n\n[study]\nrepeats = 2\n");
  for (std::vector<std::string> const& command :
       {std::vector<std::string>{"info", "setup", "study.toml"}, {"render", "study.toml", "-o", "case"}}) {
    std::vector<std::string> words = command;
    words.emplace_back("--json");
    auto const errors = nlohmann::json::parse(gladstone(words).out)["errors"];
    ASSERT_EQ(errors.size(), 1u) << errors;
    EXPECT_EQ(errors[0]["key"], "axes");
    EXPECT_EQ(errors[0]["line"], 3);
    EXPECT_EQ(errors[0]["code"], "unknown_key");
    EXPECT_THAT(errors[0]["message"].get<std::string>(), testing::HasSubstr("gladstone sweep plan"));
  }
}

TEST_F(SetupErrors, WrongTypeSaysWhatItIsAndWhatItMustBe) {
  refused("f_number = 11.0", "f_number = \"11\"", "f_number", "wrong_type");
  refused("[64, 64]", "[64.5, 64]", "pixels", "wrong_type", {"64.5"});
  refused("[64, 64]", "64", "pixels", "wrong_type", {" 2 "});
}

TEST_F(SetupErrors, SyntaxErrorHasLineAndColumn) {
  write("setup.toml", with(small_setup, "f_number = 11.0", "f_number = = 11.0"));
  expect_error({"render", "setup.toml", "-o", "case"}, 2, "syntax at setup.toml:10:12");
}

TEST_F(SetupErrors, NanIsNoNumber) { refused("f_number = 11.0", "f_number = nan", "f_number", "out_of_range"); }

TEST_F(SetupErrors, NegativePitch) {
  refused("pixel_pitch_um = 10.0", "pixel_pitch_um = -10.0", "pixel_pitch_um", "out_of_range", {"-10"});
}

TEST_F(SetupErrors, ZeroPixels) { refused("[64, 64]", "[0, 64]", "pixels", "out_of_range", {" 0,"}); }

// 1e12 pixels, two frames of 18 bytes: 36 TB. Only the check before the allocation knows the place in the setup: memory
// that cannot be allocated is reported without one.
TEST_F(SetupErrors, AbsurdSizeIsRefusedWithItsPlaceBeforeItIsAllocated) {
  std::string text = with(small_setup, "[64, 64]", "[1000000, 1000000]");
  text = with(text, "dots_per_32px_window = 10.0", "dots_per_32px_window = 0.001");
  text = with(text, "pixel_pitch_um = 10.0", "pixel_pitch_um = 1.0");
  expect_setup_error(text, "memory at setup.toml:" + place_of(text, "pixels"));
  refused("[64, 64]", "[1000000, 1000000]", "dots_per_32px_window", "invalid_value", {" GB", "camera.pixels"});
}

TEST_F(SetupErrors, RejectsFNumberBelowOneHalf) {
  refused("f_number = 11.0", "f_number = 1e-300", "f_number", "invalid_value", {"0.5"});
}

TEST_F(SetupErrors, NegativeDensitiesOfClosedForms) {
  std::string const gradient = "kind = \"uniform_gradient\"\ngradient_kg_m4 = [20.0, 10.0, 0.0]";
  refused(gradient, "kind = \"sinusoid\"\namplitude_kg_m3 = -1.5\nwavelength_mm = 8", "amplitude_kg_m3",
          "invalid_value", {"-0.275 kg/m^3"});
  for (std::string const kind : {"gaussian_blob", "gaussian_plume"}) {
    refused(gradient, "kind = \"" + kind + "\"\namplitude_kg_m3 = -2\nradius_mm = 3", "amplitude_kg_m3",
            "invalid_value", {"-0.775 kg/m^3"});
  }
}

// Fields of files that are rejected: n - 1 = 2.26e-4 rho from -0.5 to 3.
TEST_F(SetupErrors, ClosedFormsThatNoMediumIs) {
  std::string const gradient = "kind = \"uniform_gradient\"\ngradient_kg_m4 = [20.0, 10.0, 0.0]";
  for (std::string const steep : {"[1e18, 0, 0]", "[1e300, 0, 0]", "[0, 0, -1e6]", "[2e6, 2e6, 0]"}) {
    refused(gradient, "kind = \"uniform_gradient\"\ngradient_kg_m4 = " + steep, "gradient_kg_m4", "invalid_value",
            {" -", "medium.gladstone_dale"});
  }
  for (std::string const kind : {"gaussian_blob", "gaussian_plume"}) {
    refused(gradient, "kind = \"" + kind + "\"\namplitude_kg_m3 = 1e6\nradius_mm = 3", "amplitude_kg_m3",
            "invalid_value", {"1.00028 to 227"});
  }
  refused(gradient, "kind = \"sinusoid\"\namplitude_kg_m3 = 1e6\nwavelength_mm = 4", "amplitude_kg_m3", "invalid_value",
          {"-225"});
  refused(gradient, "kind = \"normal_shock\"\nmach = 3\nupstream_density_kg_m3 = 1e5\nshock_thickness_mm = 1",
          "upstream_density_kg_m3", "invalid_value", {"23.6 to 88.1714"});
  refused("[medium.field]", "[medium]\nambient_density_kg_m3 = 1e4\ngladstone_dale = 0.1\n[medium.field]",
          "ambient_density_kg_m3", "invalid_value", {"1001", "medium.gladstone_dale"});
}

// Ten times the 1000 mm between dots and lens, to each side.
TEST_F(SetupErrors, ViewsAndTargetsWiderThanAnyLensSees) {
  refused("dots_per_32px_window = 10.0", "dots_per_32px_window = 1e-9\nextent_mm = [1e9, 1e9]", "extent_mm",
          "invalid_value", {"2e+04 mm"});
  refused("[64, 64]\npixel_pitch_um = 10.0", "[400, 400]\npixel_pitch_um = 1e4", "pixel_pitch_um", "invalid_value",
          {"3.41e+04 x 3.41e+04 mm", "168 degrees"});
}

TEST_F(SetupErrors, LengthsThatLookLikeMetres) {
  refused("z_a_mm = 750.0\nz_d_mm = 250.0", "z_a_mm = 0.75\nz_d_mm = 0.25", "z_a_mm", "invalid_value",
          {"1 m are 1000 mm"});
  refused("z_d_mm = 250.0", "z_d_mm = 0.25", "z_d_mm", "invalid_value", {"0.25 m are 250 mm"});
  refused("pixel_pitch_um = 10.0", "pixel_pitch_um = 10e-6", "pixel_pitch_um", "invalid_value", {" um"});
  refused("z_a_mm", "z_a", "z_a", "unknown_key", {"\"z_a\"", "\"z_a_mm\""});
}

TEST_F(SetupErrors, CommonSlipsInTomlComeWithTheirCure) { refused("\"bos\"", "bos", "bos", "syntax"); }

TEST_F(SetupErrors, UnknownKindListsThoseThatExist) {
  refused("\"uniform_gradient\"", "\"uniform_gradiant\"", "kind", "unknown_choice",
          {"\"gaussian_plume\"", "\"uniform_gradient\""});
}

TEST_F(SetupErrors, DotsInsideTheField) {
  refused("z_d_mm = 250.0", "z_d_mm = 4.0", "z_d_mm", "invalid_value", {"5 mm"});
}

TEST_F(SetupErrors, LensInsideTheField) { refused("z_a_mm = 750.0", "z_a_mm = 4.0", "z_a_mm", "invalid_value"); }

TEST_F(SetupErrors, FocusIsImpossible) {
  refused("focal_length_mm = 105.0", "focal_length_mm = 1000.0", "z_a_mm", "invalid_value", {"1000 mm"});
}

TEST_F(SetupErrors, WindowLargerThanTheImage) {
  refused("[32, 16]", "[128, 16]", "window_px", "invalid_value", {"128 px", "64 x 64 px"});
}

TEST_F(SetupErrors, TargetSmallerThanTheView) {
  refused("[target]", "[target]\nextent_mm = [1.0, 1.0]", "extent_mm", "invalid_value");
}

TEST_F(SetupErrors, DiffractionSpotBeyondReasonAndStepsWithoutEnd) {
  refused("f_number = 11.0", "f_number = 1e300", "f_number", "invalid_value");
  refused("[medium.field]", "[medium]\nstep_mm = 1e-300\n[medium.field]", "step_mm", "invalid_value", {"\"auto\""});
}

TEST_F(SetupErrors, MissingSetupFile) {
  expect_error({"render", "nowhere.toml", "-o", "case"}, 2, "missing_file at nowhere.toml");
}

TEST_F(SetupErrors, AFolderIsNoSetup) {
  std::filesystem::create_directory(in("folder"));
  expect_error({"render", "folder", "-o", "case"}, 2, "unreadable_file at folder");
}

TEST_F(SetupErrors, BinaryRubbishIsNoSetup) {
  write("setup.toml", std::string("\x00\xff\xfe\x80rubbish\x00", 12));
  expect_error({"render", "setup.toml", "-o", "case"}, 2, "syntax at setup.toml:1:1");
}

TEST_F(SetupErrors, SeveralProblemsComeTogetherInTheOrderOfTheFile) {
  std::string text = with(small_setup, "pixel_pitch_um = 10.0", "pixel_pitch_um = -10.0");
  text = with(text, "f_number = 11.0", "fnumber = 11.0");
  text = with(text, "rays_per_dot = 32", "rays_per_dot = 0.5");
  write("setup.toml", text);
  Outcome const outcome = gladstone({"render", "setup.toml", "-o", "case", "--set", "lens.psf=square", "--json"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(errors_in(outcome.out),
              testing::ElementsAre("out_of_range at setup.toml:" + place_of(text, "pixel_pitch_um"),
                                   "unknown_key at setup.toml:" + place_of(text, "fnumber"),
                                   "out_of_range at setup.toml:" + place_of(text, "rays_per_dot"),
                                   "unknown_choice at --set lens.psf=square"));
  EXPECT_EQ(names(), std::vector<std::string>{"setup.toml"});
}

TEST_F(SetupErrors, TablesAndChoicesOfOtherExperimentsAreRefused) {
  refused("\"bos\"", "\"piv\"", "target]", "invalid_value", {"[particles]"});
  refused("[correlate]", "[correlate]\nmethod = \"rcp\"", "method = \"rcp\"", "unknown_choice", {"\"scc\"", "\"rpc\""});
  std::string const two = with(with(small_setup, "[camera]", "[[camera]]"), "[lens]", "[[camera]]\n[lens]");
  expect_setup_error(two, "missing_key at setup.toml:" + place_of(two, "[[camera]]"), {"camera.name"});
  expect_setup_error(std::string(small_setup) + "[flow]\nkind = \"uniform\"\n", "invalid_value at setup.toml:30:2");
}

TEST_F(SetupErrors, RejectsMalformedSetOption) {
  auto const refuse = [&](std::string const& assignment, std::string const& code, std::string const& value = "") {
    expect_error({"render", "setup.toml", "-o", "case", "--set", assignment}, 2, code + " at --set " + assignment,
                 {value});
  };
  refuse("lens.f_number", "syntax", "\"=\"");
  refuse("lens.f_number=", "syntax");
  refuse("=3", "syntax");
  refuse("lens.fnumber=3", "unknown_key", "\"f_number\"");
  refuse("lens.f_number=-3", "out_of_range");
  refuse("schema.deep=1", "wrong_type");
  refuse("camera.pixels=64,64", "wrong_type", "[64,64]");
}

}  // namespace
}  // namespace gladstone::end_to_end
