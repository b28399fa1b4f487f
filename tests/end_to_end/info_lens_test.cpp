#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::HasSubstr;

/// gladstone info lens: cardinal points and field properties of a prescription.
class InfoLens : public ProgramFixture {
 protected:
  static constexpr char const* singlet = R"(schema = 1
title = "plano-convex"
f_number = 10.0
field_deg = [0.0, 5.0]
[[surface]]
radius_mm = 51.5
thickness_mm = 3.6
index = 1.5168
stop = true
[[surface]]
semi_diameter_mm = 12.7
)";
};

// A plano-convex lens, curved side first: f = R / (n - 1), back focus f - t / n, entrance pupil f / 10 at its vertex.
TEST_F(InfoLens, PrintsTheCardinalPointsOfASinglet) {
  write("lens.toml", singlet);
  auto const json = json_of({"info", "lens", "lens.toml"});
  double const f = 51.5 / 0.5168;
  EXPECT_NEAR(json["effective_focal_length_mm"], f, 1e-10);
  EXPECT_NEAR(json["back_focal_length_mm"], f - 3.6 / 1.5168, 1e-10);
  EXPECT_NEAR(json["f_number"], 10, 1e-12);
  EXPECT_NEAR(json["entrance_pupil_mm"]["diameter"], f / 10, 1e-11);
  EXPECT_NEAR(json["entrance_pupil_mm"]["position"], 0, 1e-15);
  EXPECT_GT(json["spot_rms_um"]["5_deg"], json["spot_rms_um"]["on_axis"]);
}

// F2 is a glass of SCHOTT and of CDGM: the list names the one that was taken, and the other one.
TEST_F(InfoLens, ListsTheGlassesWithTheirCatalogues) {
  write("named.toml", R"(schema = 1
entrance_pupil_mm = 5.0
[[surface]]
radius_mm = 50.0
thickness_mm = 3.0
glass = "F2"
semi_diameter_mm = 10.0
stop = true
[[surface]]
thickness_mm = 2.0
[[surface]]
thickness_mm = 2.0
glass = "N-BK7"
[[surface]]
)");
  auto const glasses = json_of({"info", "lens", "named.toml"})["glasses"];
  ASSERT_EQ(glasses.size(), 2u);
  EXPECT_EQ(glasses[0]["name"], "F2");
  EXPECT_EQ(glasses[0]["catalogue"], "SCHOTT:F2");
  EXPECT_EQ(glasses[0]["surfaces"], nlohmann::json({1}));
  EXPECT_NEAR(glasses[0]["index"], 1.62004, 1e-5);  // nd of SCHOTT's data sheet
  EXPECT_THAT(glasses[0]["also_in"].dump(), HasSubstr("CDGM:F2"));
  EXPECT_EQ(glasses[1]["catalogue"], "SCHOTT:N-BK7");
  std::string const text = succeed({"info", "lens", "named.toml"});
  EXPECT_THAT(text, HasSubstr("glass F2 behind surface 1: SCHOTT:F2"));
  EXPECT_THAT(text, HasSubstr("also in "));
}

// Third-order spherical aberration: for a plano-convex lens, curved side first, the rms spot in the narrowest cross
// section decreases as the cube of the aperture.
TEST_F(InfoLens, SpotFallsAsTheCubeOfTheAperture) {
  double last = 0;
  for (char const* number : {"10.0", "20.0", "40.0"}) {
    write("lens.toml", with(singlet, "f_number = 10.0", std::string("f_number = ") + number));
    double const spot = json_of({"info", "lens", "lens.toml"})["field"][0]["best_spot_rms_um"];
    if (last > 0) {
      EXPECT_NEAR(last / spot, 8, 0.2);
    }
    last = spot;
  }
}

// Lost rays are counted by surface and cause. Behind a stop of f/20 the light meets an edge of 3 mm within r (1 - t /
// (n f')) of the axis, f' = n R / (n - 1) of the first face; the edge transmits the square of 3 mm over that radius.
TEST_F(InfoLens, CountsLostRaysBySurfaceAndCause) {
  write("lens.toml", with(singlet, "semi_diameter_mm = 12.7", "semi_diameter_mm = 3.0"));
  auto const field = json_of({"info", "lens", "lens.toml"})["field"][0];
  double const f = 51.5 / 0.5168, rim = f / 20 * (1 - 3.6 * 0.5168 / (1.5168 * 51.5));
  // 2000 uniform points determine areas to about one part in the square root of their number on the edge; spherical
  // aberration moves the edge by a thousandth
  EXPECT_NEAR(field["vignetting"], 1 - 9 / (rim * rim), 0.01);
  ASSERT_EQ(field["lost"].size(), 1u);
  EXPECT_EQ(field["lost"][0]["surface"], 2);
  EXPECT_EQ(field["lost"][0]["cause"], "vignetted");
  EXPECT_NEAR(field["lost"][0]["share"], field["vignetting"].get<double>(), 0.02);
}

// The exit pupil of a telecentric lens is at the stop, to rounding: this is printed as 0, without sign or digits.
TEST_F(InfoLens, TellsNoRoundingOfALengthThatIsNone) {
  std::string const text = succeed({"info", "lens", GLADSTONE_DATA_DIR "/lenses/telecentric.toml"});
  EXPECT_THAT(text, testing::ContainsRegex("exit pupil, position +0 mm  .from the last vertex."));
  EXPECT_THAT(text, testing::ContainsRegex("exit pupil, diameter +3.2 mm\n"));
  EXPECT_THAT(text, testing::ContainsRegex("back focal length +0 mm "));
  EXPECT_THAT(text, testing::Not(HasSubstr(" -0 mm")));
}

TEST_F(InfoLens, DrawsTheLens) {
  write("lens.toml", singlet);
  succeed({"info", "lens", "lens.toml", "--figure", "lens.png"});
  EXPECT_THAT(read("lens.png"), HasSubstr("PNG"));
}

TEST_F(InfoLens, NamesFileLineAndCauseOfABadPrescription) {
  write("lens.toml", with(singlet, "index = 1.5168", "glass = \"N-BK77\""));
  expect_error({"info", "lens", "lens.toml"}, 2, "unknown_choice at lens.toml:8:1", {"\"SCHOTT:N-BK7\""});
}

}  // namespace
}  // namespace gladstone::end_to_end
