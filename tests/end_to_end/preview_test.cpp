#include <cmath>

#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::HasSubstr;

/// gladstone render --preview: a part of the images of a setup.
class Preview : public ProgramFixture {
 protected:
  static std::string larger_setup() {
    return with(automatic_setup(), "pixels = [64, 64]", "pixels = [160, 144]\nexposure = 20000.0");
  }
};

// The picture shows blocks of 3 x 3 pixels of both frames, with a gap of 4; full scale is 65535.
TEST_F(Preview, HasThePixelsOfTheCompleteImages) {
  write("setup.toml", larger_setup());
  auto const json = json_of({"render", "setup.toml", "--preview", "-o", "part.png"});
  EXPECT_EQ(json["pixels"], nlohmann::json({128, 128}));
  EXPECT_EQ(json["frames"], 2);
  render("case");
  Image<double> const picture = read_image(in("part.png").string());
  ASSERT_EQ(picture.columns(), 2 * 384 + 4);
  ASSERT_EQ(picture.rows(), 384);
  int const first_column = json["first_px"][0], first_row = json["first_px"][1];
  for (int frame = 0; frame < 2; ++frame) {
    Image<double> const whole = read_image(in(frame == 0 ? "case/reference.tif" : "case/flow.tif").string());
    double largest = 0, brightest = 0;
    for (int row = 0; row < 128; ++row) {
      for (int column = 0; column < 128; ++column) {
        double const level = whole(first_column + column, first_row + row) / 65535 * 255;
        largest = std::max(largest, std::abs(level - picture(frame * 388 + 3 * column + 1, 3 * row + 1)));
        brightest = std::max(brightest, level);
      }
    }
    EXPECT_LT(largest, 2.0) << frame;  // rounding to 256 levels, and the scatter of 32 rays
    EXPECT_GT(brightest, 100) << frame;
  }
}

// The gradient of the path-averaged density of a blob, exp(-r^2 / R^2), is largest at r = R / sqrt(2).
TEST_F(Preview, IsAboutTheStrongestGradient) {
  std::string const wide = with(larger_setup(), "pixels = [160, 144]", "pixels = [400, 400]");
  write("setup.toml", with(wide, "kind = \"uniform_gradient\"\ngradient_kg_m4 = [20.0, 10.0, 0.0]",
                           "kind = \"gaussian_blob\"\namplitude_kg_m3 = -0.3\nradius_mm = 10.0"));
  auto const json = json_of({"render", "setup.toml", "--preview"});
  EXPECT_TRUE(json["at_gradient"]);
  double const magnification_at_medium = 105.0 / 895 * 1000 / 750;
  double const x = json["first_px"][0].get<double>() + 63.5 - 199.5;
  double const y = json["first_px"][1].get<double>() + 63.5 - 199.5;
  EXPECT_NEAR(std::hypot(x, y), 10 / std::sqrt(2.0) * magnification_at_medium / 0.01, 8);
  EXPECT_THAT(names(), testing::Contains("preview.png"));
}

TEST_F(Preview, ShowsEveryKindOfExperiment) {
  for (std::string const kind : {"piv", "calibration"}) {
    succeed({"init", kind, "-o", kind + ".toml"});
    auto const json =
        json_of({"render", kind + ".toml", "--preview", "-o", kind + ".png", "--set", "render.rays_per_dot=16"});
    EXPECT_EQ(json["frames"], kind == "piv" ? 2 : 1);
    EXPECT_FALSE(json["at_gradient"]);
    EXPECT_GT(json["sources"], 0);
    EXPECT_TRUE(std::filesystem::exists(in(kind + ".png"))) << kind;
  }
}

TEST_F(Preview, SaysWhatItLeavesOut) {
  EXPECT_THAT(succeed({"render", "setup.toml", "--preview"}),
              testing::AllOf(HasSubstr("left out: the rest of the image"), ContainsWhole("32 rays per source")));
}

TEST_F(Preview, RefusesBadOutputs) {
  expect_error({"render", "setup.toml", "--preview", "-o", "setup.toml"}, 2, "output at setup.toml");
  write("dots.png", "x_mm,y_mm\n0,0\n1,1\n-1,1\n");
  write("points.toml",
        with(automatic_setup(), "dots_per_32px_window = 10.0", "kind = \"points\"\nfile = \"dots.png\""));
  expect_error({"render", "points.toml", "--preview", "-o", "dots.png"}, 2, "overwrites_input at dots.png");
  expect_error({"render", "setup.toml"}, 2, "arguments at --output");
}

}  // namespace
}  // namespace gladstone::end_to_end
