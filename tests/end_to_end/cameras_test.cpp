#include <cmath>

#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

namespace fs = std::filesystem;

/// The small setup seen by two cameras 10 degrees to either side, the second one with a longer lens.
constexpr char const* stereo = R"(schema = 1

[[camera]]
name = "left"
pixels = [64, 64]
[camera.pose]
position_mm = [-132.3, 0.0, 750.0]
[camera.noise]
seed = 5

[[camera]]
name = "right"
pixels = [96, 64]
[camera.pose]
position_mm = [132.3, 0.0, 750.0]
[camera.lens]
focal_length_mm = 120.0
f_number = 11.0
[camera.noise]
seed = 5

[lens]
focal_length_mm = 105.0
f_number = 11.0

[geometry]
z_d_mm = 250.0

[medium.field]
kind = "uniform_gradient"
gradient_kg_m4 = [20.0, 10.0, 0.0]

[target]
dots_per_32px_window = 10.0

[render]
rays_per_dot = 32

[correlate]
window_px = [32, 16]
overlap = 0.5
)";

class Cameras : public ProgramFixture {
 protected:
  void SetUp() override {
    ProgramFixture::SetUp();
    write("setup.toml", stereo);
  }
  std::vector<double> dataset(std::string const& file, std::string const& name) const {
    return Hdf5Reader(in(file).string()).read(name);
  }
};

TEST_F(Cameras, EachGivesACaseOfItsOwn) {
  auto const json = json_of({"render", "setup.toml", "-o", "case", "--quiet"});
  EXPECT_EQ(names("case"), (std::vector<std::string>{"left", "right", "setup.toml", "summary.json"}));
  std::vector<std::string> const files{"flow.tif", "reference.tif", "setup.toml", "summary.json", "truth.h5"};
  EXPECT_EQ(names("case/left"), files);
  EXPECT_EQ(names("case/right"), files);
  auto summary = json;
  EXPECT_TRUE(summary["warnings"].is_array());
  for (char const* key : {"warnings", "warning_records"}) summary.erase(key);  // warnings of the run
  EXPECT_EQ(summary, nlohmann::json::parse(read("case/summary.json")));
  EXPECT_EQ(json["cameras"]["left"], nlohmann::json::parse(read("case/left/summary.json")));
  // the longer lens sees the dots larger: M = f / (Z_B - f) with Z_B = 1015.4 mm
  double const z_b = 1000 / std::cos(std::atan(132.3 / 750));
  EXPECT_NEAR(json["cameras"]["left"]["magnification"].get<double>(), 105 / (z_b - 105), 2e-3);
  EXPECT_NEAR(json["cameras"]["right"]["magnification"].get<double>(), 120 / (z_b - 120), 2e-3);
}

// Both see the same dots, from their sides.
TEST_F(Cameras, SeeOneTarget) {
  render("case");
  auto const left = dataset("case/left/truth.h5", "/dots/position_m"),
             right = dataset("case/right/truth.h5", "/dots/position_m");
  EXPECT_EQ(left, right);
  EXPECT_GT(left.size(), 3u * 40);
  EXPECT_NE(dataset("case/left/truth.h5", "/dots/reference_px"), dataset("case/right/truth.h5", "/dots/reference_px"));
}

// Dots of a file have one size on the target, too, whatever the lens: 3 px of the first camera. They are at the
// intersections of the axes with the target, 132.3 mm / 750 mm of 250 mm from its middle.
TEST_F(Cameras, SeeDotsOfAFileInOneSize) {
  write("dots.csv", "x_mm,y_mm\n44.1,0\n44.6,0.5\n-44.1,0\n-44.6,0.5\n");
  std::string text = stereo;
  std::string const dots = "dots_per_32px_window = 10.0";
  text.replace(text.find(dots), dots.size(), "kind = \"points\"\nfile = \"dots.csv\"\ndot_diameter_px = 3.0");
  write("points.toml", text);
  render("case", {}, "points.toml");
  auto const diameter_mm = [this](std::string const& camera) {
    std::string const setup = read("case/" + camera + "/setup.toml"), key = "dot_diameter_mm = ";
    auto const at = setup.find(key);
    return at == std::string::npos ? 0.0 : std::stod(setup.substr(at + key.size()));
  };
  // M = f / (Z_B - f), Z_B = 1015.4 mm, pixels of 10 um; the target, inclined by 10 degrees, is stretched in one
  // direction
  double const cosine = std::cos(std::atan(132.3 / 750)), z_b = 1000 / cosine;
  double const expected = 0.03 * (z_b - 105) / 105 / std::sqrt(cosine);
  EXPECT_NEAR(diameter_mm("left"), expected, 1e-9);
  EXPECT_NEAR(diameter_mm("right"), expected, 1e-9);
}

TEST_F(Cameras, EachCaseIsACaseLikeAnyOther) {
  render("case");
  EXPECT_GT(json_of({"correlate", "case/left", "--quiet"})["valid"].get<int>(), 0);
  EXPECT_TRUE(json_of({"compare", "case/left", "--quiet", "--no-figures"}).contains("ray_truth"));
  // its resolved setup is the setup of that camera
  render("again", {}, "case/right/setup.toml");
  EXPECT_EQ(read("again/reference.tif").size(), read("case/right/reference.tif").size());
  EXPECT_EQ(dataset("again/truth.h5", "/dots/displacement_px"),
            dataset("case/right/truth.h5", "/dots/displacement_px"));
}

TEST_F(Cameras, TheSetupOfAllRendersTheSameAgain) {
  render("case");
  render("again", {}, "case/setup.toml");
  for (std::string const file : {"left/truth.h5", "right/truth.h5"}) {
    EXPECT_EQ(dataset("case/" + file, "/dots/reference_px"), dataset("again/" + file, "/dots/reference_px"));
  }
  EXPECT_EQ(nlohmann::json::parse(read("case/summary.json"))["cameras"]["right"]["flow_sha256"],
            nlohmann::json::parse(read("again/summary.json"))["cameras"]["right"]["flow_sha256"]);
}

// Two cameras at one position with one seed record the same light with different noise.
TEST_F(Cameras, HaveIndependentNoise) {
  std::string text = with(with(stereo, "[132.3", "[-132.3"), "[96, 64]", "[64, 64]");
  text = with(text, "[camera.lens]\nfocal_length_mm = 120.0\nf_number = 11.0\n", "");
  write("setup.toml", text);
  render("case");
  EXPECT_EQ(dataset("case/left/truth.h5", "/dots/reference_px"), dataset("case/right/truth.h5", "/dots/reference_px"));
  Image<double> const left = read_image(in("case/left/reference.tif").string()),
                      right = read_image(in("case/right/reference.tif").string());
  double product = 0, square = 0;
  for (std::size_t i = 0; i < left.size(); ++i) {
    double const l = left.data()[i], r = right.data()[i];
    product += (l - r) * (l - r);
    square += l;
  }
  // the difference of two exposures has twice the variance of one: in levels, twice the level times 65535 / 30000; a
  // few hundred illuminated pixels determine it to a tenth
  EXPECT_NEAR(product / (2 * square * 65535.0 / 30000), 1.0, 0.3);
}

TEST_F(Cameras, LookThroughTheWindowsThatNameThem) {
  std::string const text = with(stereo, "[target]", "[target]\nextent_mm = [100, 10]");
  write("setup.toml", text + "[[window]]\nposition_mm = [0, 0, 100]\nthickness_mm = 20\ncameras = [\"right\"]\n");
  render("case");
  EXPECT_EQ(read("case/left/setup.toml").find("[[window]]"), std::string::npos);
  EXPECT_NE(read("case/right/setup.toml").find("[[window]]"), std::string::npos);
  write("setup.toml", text);
  render("plain");
  auto const seen = [&](std::string const& file) { return dataset(file, "/dots/reference_px"); };
  EXPECT_EQ(seen("case/left/truth.h5"), seen("plain/left/truth.h5"));
  // 20 mm of glass at 10 degrees: at the intersection of the axis with the target, objects behind it are displaced by t
  // (tan 10 - tan 6.57) cos 10 = 1.20 mm perpendicular to the axis, times 0.134 = 16.1 px
  auto const through = seen("case/right/truth.h5"), without = seen("plain/right/truth.h5");
  ASSERT_EQ(through.size(), without.size());
  std::size_t nearest = 0;
  for (std::size_t k = 0; k < without.size(); k += 2) {
    if (std::abs(without[k] - 47.5) < std::abs(without[nearest] - 47.5)) nearest = k;
  }
  EXPECT_LT(std::abs(without[nearest] - 47.5), 5);
  EXPECT_NEAR(std::abs(through[nearest] - without[nearest]), 16.1, 0.5);
  // in the general table, the same window
  write("setup.toml", text +
                          "[[element]]\nkind = \"window\"\nposition_mm = [0, 0, 100]\nthickness_mm = 20\n"
                          "cameras = [\"right\"]\n");
  render("general");
  EXPECT_EQ(seen("general/left/truth.h5"), seen("plain/left/truth.h5"));
  EXPECT_EQ(seen("general/right/truth.h5"), through);
}

TEST_F(Cameras, OneCameraMayHaveItsOwnLens) {
  std::string const text =
      with(with(small_setup, "[lens]\nfocal_length_mm = 105.0\nf_number = 11.0\n", ""), "pixel_pitch_um = 10.0",
           "pixel_pitch_um = 10.0\nname = \"only\"\n[camera.lens]\nfocal_length_mm = 120.0\nf_number = 11.0");
  write("setup.toml", text);
  EXPECT_NEAR(json_of({"render", "setup.toml", "-o", "case", "--quiet"})["magnification"].get<double>(),
              120 / (1000 - 120.0), 1e-12);
  EXPECT_TRUE(fs::exists(in("case/reference.tif")));
}

TEST_F(Cameras, MistakesStandAtTheirPlace) {
  auto const refused = [this](std::string const& old, std::string const& replacement, std::string const& at,
                              std::string const& code, std::vector<std::string> const& values = {}) {
    std::string const text = with(stereo, old, replacement);
    expect_setup_error(text, code + " at setup.toml:" + place_of(text, at), values);
  };
  refused("name = \"right\"", "name = \"left\"  # twice", "name = \"left\"  # twice", "invalid_value", {"\"left\""});
  refused("name = \"right\"", "name = \"a/b\"", "name = \"a/b\"", "invalid_value");
  refused("focal_length_mm = 120.0", "focal_lenth_mm = 120.0", "focal_lenth_mm", "unknown_key",
          {"\"focal_length_mm\""});
  refused("[96, 64]", "[0, 64]", "pixels = [0", "out_of_range", {" 1 "});
  refused("[correlate]", "[[window]]\nposition_mm = [0, 0, 100]\ncameras = [\"rigth\"]\n[correlate]", "cameras",
          "invalid_value", {"\"rigth\"", "\"left\" or \"right\""});
  std::string const nameless = with(stereo, "name = \"right\"\n", "");
  expect_setup_error(nameless, "missing_key at setup.toml:11:1", {"camera.name"});
}

TEST_F(Cameras, ProblemsOfAllComeTogetherAndOnce) {
  std::string text = with(stereo, "[64, 64]", "[0, 64]");
  text = with(text, "[96, 64]", "[96, 0]");
  text = with(text, "dots_per_32px_window", "dots_per_window");
  write("setup.toml", text);
  Outcome const outcome = gladstone({"render", "setup.toml", "-o", "case", "--json"});
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_THAT(errors_in(outcome.out),
              testing::UnorderedElementsAre("out_of_range at setup.toml:" + place_of(text, "pixels = [0"),
                                            "out_of_range at setup.toml:" + place_of(text, "pixels = [96"),
                                            "unknown_key at setup.toml:" + place_of(text, "dots_per_window")));
  EXPECT_FALSE(fs::exists(in("case")));
}

TEST_F(Cameras, CommandsOnOneCameraAskWhichOne) {
  render("case");
  expect_error({"correlate", "case"}, 2, "undetermined at case", {"case/left"});
  expect_error({"compare", "case"}, 2, "undetermined at case", {"case/left"});
  write("rays.csv", "x_mm,y_mm,z_mm,dx,dy,dz\n0,0,-250,0,0,1\n");
  expect_error({"trace", "setup.toml", "--rays", "rays.csv", "-o", "out.csv"}, 2, "invalid_value at setup.toml:3:3");
}

// The results of a camera are deleted together with the frames from which they were computed; files of the user remain.
TEST_F(Cameras, RenderingAgainReplacesTheWholeCase) {
  render("case");
  succeed({"correlate", "case/left", "--quiet"});
  write("case/left/notes.txt", "mine");
  write("setup.toml", with(stereo, "[20.0, 10.0", "[10.0, 20.0"));
  render("case");
  EXPECT_FALSE(fs::exists(in("case/left/vectors.h5")));
  EXPECT_EQ(read("case/left/notes.txt"), "mine");
  write("setup.toml", small_setup);
  render("case");
  EXPECT_TRUE(fs::exists(in("case/reference.tif")));
  write("setup.toml", stereo);
  render("case");
  EXPECT_FALSE(fs::exists(in("case/reference.tif")));
  EXPECT_FALSE(fs::exists(in("case/truth.h5")));
}

}  // namespace
}  // namespace gladstone::end_to_end
