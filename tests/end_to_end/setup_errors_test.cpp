#include <sys/resource.h>

#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

/// Processor time of all finished child processes [s].
double seconds_of_children() {
  rusage used{};
  ::getrusage(RUSAGE_CHILDREN, &used);
  auto const seconds = [](timeval const& time) {
    return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
  };
  return seconds(used.ru_utime) + seconds(used.ru_stime);
}

/// Invalid setups: exit code 2, place, problem and remedy, and no case folder.
class SetupErrors : public ProgramFixture {
 protected:
  /// Expects the small setup with `old` replaced to be rejected at the place of `at`, with these texts.
  void refused(std::string const& old, std::string const& replacement, std::string const& at,
               std::vector<std::string> pieces) {
    std::string const text = with(small_setup, old, replacement);
    pieces.insert(pieces.begin(), "setup.toml:" + place_of(text, at) + ": ");
    expect_setup_refused(text, pieces);
  }
};

TEST_F(SetupErrors, MisspeltKeyNamesTheNearest) {
  refused("f_number", "fnumber", "fnumber", {"unknown key \"fnumber\" in [lens]", "did you mean \"f_number\"?"});
}

TEST_F(SetupErrors, MisspeltTableNamesTheNearest) {
  refused("[lens]", "[lense]", "lense", {"unknown table [lense]", "did you mean [lens]?"});
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
    EXPECT_THAT(errors[0]["message"].get<std::string>(), testing::HasSubstr("gladstone sweep plan"));
  }
}

TEST_F(SetupErrors, WrongTypeSaysWhatItIsAndWhatItMustBe) {
  refused("f_number = 11.0", "f_number = \"11\"", "f_number", {"must be a number (it is a text)", "without quotes"});
  refused("[64, 64]", "[64.5, 64]", "pixels", {"value 1, 64.5, must be a whole number"});
  refused("[64, 64]", "64", "pixels", {"must be an array of 2 whole numbers"});
}

TEST_F(SetupErrors, SyntaxErrorHasLineAndColumn) {
  write("setup.toml", with(small_setup, "f_number = 11.0", "f_number = = 11.0"));
  expect_refused({"render", "setup.toml", "-o", "case"}, 2, {"setup.toml:10:"});
}

TEST_F(SetupErrors, NanIsNoNumber) {
  refused("f_number = 11.0", "f_number = nan", "f_number", {"must be a number (nan is not allowed)"});
}

TEST_F(SetupErrors, NegativePitch) {
  refused("pixel_pitch_um = 10.0", "pixel_pitch_um = -10.0", "pixel_pitch_um", {"-10", "must be greater than 0"});
}

TEST_F(SetupErrors, ZeroPixels) { refused("[64, 64]", "[0, 64]", "pixels", {"value 1, 0, must be at least 1"}); }

TEST_F(SetupErrors, AbsurdSizeIsRefusedWithItsMemoryBeforeItIsAllocated) {
  // 1e12 pixels, two frames of 18 bytes: 36 TB
  std::string text = with(small_setup, "[64, 64]", "[1000000, 1000000]");
  text = with(text, "dots_per_32px_window = 10.0", "dots_per_32px_window = 0.001");
  text = with(text, "pixel_pitch_um = 10.0", "pixel_pitch_um = 1.0");
  double const before = seconds_of_children();
  expect_setup_error(text, "memory at setup.toml:5:1");
  EXPECT_LT(seconds_of_children() - before, 5);
  refused("[64, 64]", "[1000000, 1000000]", "dots_per_32px_window", {"GB of memory", "camera.pixels"});
}

TEST_F(SetupErrors, TooLittleMemoryStandsAtThePixelsThatTakeIt) {
  std::string text = with(small_setup, "[64, 64]", "[1000000, 1000000]");
  text = with(text, "dots_per_32px_window = 10.0", "dots_per_32px_window = 0.001");
  text = with(text, "pixel_pitch_um = 10.0", "pixel_pitch_um = 1.0");
  expect_setup_error(text, "memory at setup.toml:" + place_of(text, "pixels"));
}

TEST_F(SetupErrors, RejectsFNumberBelowOneHalf) {
  refused("f_number = 11.0", "f_number = 1e-300", "f_number", {"is below 0.5", "increase it"});
}

TEST_F(SetupErrors, NegativeDensitiesOfClosedForms) {
  std::string const gradient = "kind = \"uniform_gradient\"\ngradient_kg_m4 = [20.0, 10.0, 0.0]";
  refused(gradient, "kind = \"sinusoid\"\namplitude_kg_m3 = -1.5\nwavelength_mm = 8", "amplitude_kg_m3",
          {"makes the density negative, -0.275 kg/m^3", "reduce the amplitude"});
  for (std::string const kind : {"gaussian_blob", "gaussian_plume"}) {
    refused(gradient, "kind = \"" + kind + "\"\namplitude_kg_m3 = -2\nradius_mm = 3", "amplitude_kg_m3",
            {"makes the density negative, -0.775 kg/m^3", "increase the ambient density"});
  }
}

// Fields of files that are rejected: n - 1 = 2.26e-4 rho from -0.5 to 3.
TEST_F(SetupErrors, ClosedFormsThatNoMediumIs) {
  std::string const gradient = "kind = \"uniform_gradient\"\ngradient_kg_m4 = [20.0, 10.0, 0.0]";
  for (std::string const steep : {"[1e18, 0, 0]", "[1e300, 0, 0]", "[0, 0, -1e6]", "[2e6, 2e6, 0]"}) {
    refused(gradient, "kind = \"uniform_gradient\"\ngradient_kg_m4 = " + steep, "gradient_kg_m4",
            {"gives refractive indices from -", "no medium has such"});
  }
  for (std::string const kind : {"gaussian_blob", "gaussian_plume"}) {
    refused(gradient, "kind = \"" + kind + "\"\namplitude_kg_m3 = 1e6\nradius_mm = 3", "amplitude_kg_m3",
            {"gives refractive indices from 1.00028 to 227", "no medium has such"});
  }
  refused(gradient, "kind = \"sinusoid\"\namplitude_kg_m3 = 1e6\nwavelength_mm = 4", "amplitude_kg_m3",
          {"gives refractive indices from -225", "no medium has such"});
  refused(gradient, "kind = \"normal_shock\"\nmach = 3\nupstream_density_kg_m3 = 1e5\nshock_thickness_mm = 1",
          "upstream_density_kg_m3", {"gives refractive indices from 23.6 to 88", "no medium has such"});
  refused("[medium.field]", "[medium]\nambient_density_kg_m3 = 1e4\ngladstone_dale = 0.1\n[medium.field]",
          "ambient_density_kg_m3", {"gives a refractive index of 1001", "medium.gladstone_dale"});
}

// Ten times the 1000 mm between dots and lens, to each side.
TEST_F(SetupErrors, ViewsAndTargetsWiderThanAnyLensSees) {
  refused("dots_per_32px_window = 10.0", "dots_per_32px_window = 1e-9\nextent_mm = [1e9, 1e9]", "extent_mm",
          {"exceeds the largest supported field of view", "2e+04 mm"});
  refused("[64, 64]\npixel_pitch_um = 10.0", "[400, 400]\npixel_pitch_um = 1e4", "pixel_pitch_um",
          {"makes a field of view of 3.41e+04 x 3.41e+04 mm", "168 degrees, are supported"});
}

TEST_F(SetupErrors, LengthsThatLookLikeMetres) {
  refused("z_a_mm = 750.0\nz_d_mm = 250.0", "z_a_mm = 0.75\nz_d_mm = 0.25", "z_a_mm",
          {"focus is impossible", "lengths are in mm: 1 mm was given, 1 m are 1000 mm"});
  refused("z_d_mm = 250.0", "z_d_mm = 0.25", "z_d_mm", {"inside the medium", "0.25 m are 250 mm"});
  refused("pixel_pitch_um = 10.0", "pixel_pitch_um = 10e-6", "pixel_pitch_um", {"pitches are in um"});
  refused("z_a_mm", "z_a", "z_a", {"unknown key \"z_a\"", "did you mean \"z_a_mm\"?"});
}

TEST_F(SetupErrors, CommonSlipsInTomlComeWithTheirCure) {
  refused("\"bos\"", "bos", "bos", {"is not TOML", "put texts in quotes"});
}

TEST_F(SetupErrors, UnknownKindListsThoseThatExist) {
  refused("\"uniform_gradient\"", "\"uniform_gradiant\"", "kind",
          {"\"gaussian_plume\"", "did you mean \"uniform_gradient\"?"});
}

TEST_F(SetupErrors, DotsInsideTheField) {
  refused("z_d_mm = 250.0", "z_d_mm = 4.0", "z_d_mm", {"the dots lie inside the medium", "increase z_d_mm beyond 5"});
}

TEST_F(SetupErrors, LensInsideTheField) { refused("z_a_mm = 750.0", "z_a_mm = 4.0", "z_a_mm", {"increase z_a_mm"}); }

TEST_F(SetupErrors, FocusIsImpossible) {
  refused("focal_length_mm = 105.0", "focal_length_mm = 1000.0", "z_a_mm", {"focus is impossible"});
}

TEST_F(SetupErrors, WindowLargerThanTheImage) {
  refused("[32, 16]", "[128, 16]", "window_px", {"a window of 128 px is larger than the image of 64 x 64 px"});
}

TEST_F(SetupErrors, TargetSmallerThanTheView) {
  refused("[target]", "[target]\nextent_mm = [1.0, 1.0]", "extent_mm", {"is larger than the target"});
}

TEST_F(SetupErrors, DiffractionSpotBeyondReasonAndStepsWithoutEnd) {
  refused("f_number = 11.0", "f_number = 1e300", "f_number", {"diffraction spot", "open the lens"});
  refused("[medium.field]", "[medium]\nstep_mm = 1e-300\n[medium.field]", "step_mm", {"use \"auto\" or a longer step"});
}

TEST_F(SetupErrors, MissingSetupFile) {
  expect_refused({"render", "nowhere.toml", "-o", "case"}, 2, {"nowhere.toml: does not exist"});
}

TEST_F(SetupErrors, AFolderIsNoSetup) {
  std::filesystem::create_directory(in("folder"));
  expect_refused({"render", "folder", "-o", "case"}, 2, {"folder: is a folder; name a setup file"});
}

TEST_F(SetupErrors, BinaryRubbishIsNoSetup) {
  write("setup.toml", std::string("\x00\xff\xfe\x80rubbish\x00", 12));
  expect_refused({"render", "setup.toml", "-o", "case"}, 2, {"setup.toml:1:"});
}

TEST_F(SetupErrors, SeveralProblemsComeTogetherInTheOrderOfTheFile) {
  std::string text = with(small_setup, "pixel_pitch_um = 10.0", "pixel_pitch_um = -10.0");
  text = with(text, "f_number = 11.0", "fnumber = 11.0");
  text = with(text, "rays_per_dot = 32", "rays_per_dot = 0.5");
  write("setup.toml", text);
  Outcome const outcome = gladstone({"render", "setup.toml", "-o", "case", "--set", "lens.psf=square"});
  EXPECT_EQ(outcome.exit_code, 2);
  std::size_t last = 0;
  for (std::string const& where :
       {"setup.toml:" + place_of(text, "pixel_pitch_um"), "setup.toml:" + place_of(text, "fnumber"),
        "setup.toml:" + place_of(text, "rays_per_dot"), std::string("--set lens.psf=square")}) {
    std::size_t const at = outcome.err.find(where);
    ASSERT_NE(at, std::string::npos) << where << " in\n" << outcome.err;
    EXPECT_GE(at, last) << outcome.err;
    last = at;
  }
  EXPECT_EQ(names(), std::vector<std::string>{"setup.toml"});
}

TEST_F(SetupErrors, WhatIsOfOthersOrDueLaterIsRefusedByName) {
  refused("\"bos\"", "\"piv\"", "target]", {"applies to BOS only", "[particles]", "geometry.z_d_mm"});
  refused("[correlate]", "[correlate]\nmethod = \"rcp\"", "method = \"rcp\"", {"\"scc\"", "did you mean \"rpc\"?"});
  std::string const two = with(with(small_setup, "[camera]", "[[camera]]"), "[lens]", "[[camera]]\n[lens]");
  expect_setup_refused(two, {"camera.name", "is missing"});
  expect_setup_error(std::string(small_setup) + "[flow]\nkind = \"uniform\"\n", "invalid_value at setup.toml:30:2");
}

TEST_F(SetupErrors, RejectsMalformedSetOption) {
  auto const refuse = [&](std::string const& assignment, std::string const& piece) {
    expect_refused({"render", "setup.toml", "-o", "case", "--set", assignment}, 2, {"--set " + assignment, piece});
  };
  refuse("lens.f_number", "has no \"=\"");
  refuse("lens.f_number=", "has no value");
  refuse("=3", "has an empty key");
  refuse("lens.fnumber=3", "did you mean \"f_number\"?");
  refuse("lens.f_number=-3", "must be greater than 0");
  refuse("schema.deep=1", "not a table");
  refuse("camera.pixels=64,64", "write [64,64]");
}

}  // namespace
}  // namespace gladstone::end_to_end
