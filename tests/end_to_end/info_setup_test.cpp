#include <cmath>

#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::HasSubstr;

/// gladstone info setup: what follows from a setup before it is rendered.
class InfoSetup : public ProgramFixture {
 protected:
  void SetUp() override {
    ProgramFixture::SetUp();
    write("setup.toml", automatic_setup());
  }
  nlohmann::json overview(std::string const& setup = "setup.toml") const { return json_of({"info", "setup", setup}); }
};

// A thin lens of 105 mm at f/11, 1000 mm from the dots and 750 mm from the medium; 64 x 64 pixels of 10 um.
TEST_F(InfoSetup, OfBosAgreesWithTheThinLens) {
  auto const json = overview();
  double const f = 105, z_a = 750, z_b = 1000, magnification = f / (z_b - f), pixel_at_dots = 0.01 / magnification;
  EXPECT_EQ(json["experiment"], "bos");
  EXPECT_NEAR(json["magnification"], magnification, 1e-9);
  EXPECT_NEAR(json["field_of_view_mm"][0], 64 * pixel_at_dots * z_a / z_b, 1e-9);
  EXPECT_NEAR(json["field_of_view_at_dots_mm"], 64 * pixel_at_dots, 1e-9);
  EXPECT_NEAR(json["cone_diameter_mm"], f / 11 * 250 / z_b, 1e-9);
  // M Z_D K L_z / (n0 p), with the defaults K = 2.26e-4, L_z = 10 mm, n0 = 1 + K 1.225
  double const sensitivity = magnification * 0.25 * 2.26e-4 * 0.01 / (1 + 2.26e-4 * 1.225) / 1e-5;
  EXPECT_NEAR(json["sensitivity_px_per_kg_m4"], sensitivity, 1e-9 * sensitivity);
  EXPECT_NEAR(json["displacement_px"], sensitivity * std::hypot(20, 10), 1e-9);
  // 10 dots per 32 x 32 px on the view and one window of 32 px on each side
  EXPECT_EQ(json["dots"], 160);
  EXPECT_GT(json["dots_in_view"], 20);
  EXPECT_LT(json["dots_in_view"], 60);
}

TEST_F(InfoSetup, DescribesTheOverriddenSetup) {
  auto const json = json_of({"info", "setup", "setup.toml", "--set", "lens.f_number=22"});
  EXPECT_NEAR(json["cone_diameter_mm"], 105.0 / 22 * 250 / 1000, 1e-9);
  expect_error({"info", "setup", "setup.toml", "--set", "lens.f_nubmer=22"}, 2,
               "unknown_key at --set lens.f_nubmer=22");
  expect_error({"info", "image", "a.tif", "--set", "lens.f_number=22"}, 2, "arguments at --set");
}

TEST_F(InfoSetup, EstimatesTheCostOfRendering) {
  auto const cost = overview()["render"];
  EXPECT_EQ(cost["method"], "focused_dots");
  EXPECT_EQ(cost["rays_per_source"], 32);
  EXPECT_FALSE(cost["rays_are_largest"]);
  EXPECT_EQ(cost["sources"], 160);
  EXPECT_GT(cost["processor_seconds"], 0);
  EXPECT_LT(cost["processor_seconds"], 10);
  // two images of 64-bit light, 64-bit levels and 16-bit grey levels
  EXPECT_EQ(cost["memory"]["images"], 64 * 64 * 2 * 18);
  // rays one by one: the time is proportional to their number
  write("rays.toml", with(small_setup, "rays_per_dot = 32", "rays_per_dot = 1000"));
  write("more.toml", with(small_setup, "rays_per_dot = 32", "rays_per_dot = 4000"));
  double const once = overview("rays.toml")["render"]["processor_seconds"];
  double const more = overview("more.toml")["render"]["processor_seconds"];
  EXPECT_GT(more, 3 * once);
  EXPECT_LE(more, 4 * once * (1 + 1e-9));
}

// "auto" chooses the rays of particles by the blur of their images: at f/22 in a sheet of 1 mm no particle requires
// more than the 16 of the second rule; at f/2.8 in a sheet of 4 mm, with eight times the aperture and four times the
// distance from focus, all of them do.
TEST_F(InfoSetup, ExpectsTheRaysOfPivByTheirBlur) {
  succeed({"init", "piv", "-o", "piv.toml"});
  std::string const small = with(read("piv.toml"), "pixels = [256, 256]", "pixels = [64, 64]");
  write("sharp.toml", small);
  write("blurred.toml",
        with(with(small, "f_number = 22.0", "f_number = 2.8"), "thickness_mm = 1.0", "thickness_mm = 4.0"));
  for (auto const& [setup, sharp] : {std::pair{"sharp.toml", true}, {"blurred.toml", false}}) {
    auto const cost = overview(setup)["render"];
    double const expected = cost["expected_rays"];
    EXPECT_EQ(expected == 16, sharp) << expected;
    EXPECT_LT(expected, cost["rays_per_source"]);
    double const share = expected / cost["rays_per_source"].get<double>();
    EXPECT_NEAR(cost["seconds"], share * cost["longest_seconds"].get<double>(), 1e-9);
    render("case", {}, setup);
    std::vector<double> rays = Hdf5Reader(in("case/truth.h5").string()).read("/particles/rays_planned");
    std::erase(rays, 0);  // particles out of view
    ASSERT_FALSE(rays.empty());
    std::nth_element(rays.begin(), rays.begin() + static_cast<std::ptrdiff_t>(rays.size() / 2), rays.end());
    double const median = rays[rays.size() / 2];
    EXPECT_LE(median, expected) << setup;
    EXPECT_GE(median, expected / 16) << setup << ": at most two rules fewer, for particles close to the focus";
  }
}

TEST_F(InfoSetup, DescribesEveryTemplate) {
  for (std::string const kind : {"bos", "piv", "calibration"}) {
    succeed({"init", kind, "-o", kind + ".toml"});
    auto const json = overview(kind + ".toml");
    EXPECT_EQ(json["experiment"], kind);
    EXPECT_GT(json["magnification"], 0) << kind;
    EXPECT_EQ(json["field_of_view_mm"].size(), 2u) << kind;
    EXPECT_GT(json["render"]["memory_bytes"], 0) << kind;
    EXPECT_THAT(succeed({"info", "setup", kind + ".toml"}), HasSubstr("memory")) << kind;
  }
}

// The grid of the template: 40 mm and 2.5 mm, hence 17 x 17 dots; it is in focus on Z = 0 only.
TEST_F(InfoSetup, OfACalibrationCountsTheDotsOfAPlane) {
  succeed({"init", "calibration", "-o", "planes.toml"});
  auto const json = overview("planes.toml");
  EXPECT_EQ(json["dots"], 17 * 17);
  EXPECT_EQ(json["planes"], 3);
  EXPECT_EQ(json["first_plane_mm"], -2);
  EXPECT_GT(json["first_plane_defocus_px"], 0);
  EXPECT_EQ(json["render"]["sources"], 3 * 17 * 17);
  EXPECT_EQ(json["render"]["method"], "rays");
}

TEST_F(InfoSetup, DescribesEachOfSeveralCameras) {
  succeed({"init", "stereo", "-o", "stereo.toml"});
  auto const json = overview("stereo.toml");
  ASSERT_EQ(json["cameras"].size(), 2u);
  EXPECT_NEAR(json["cameras"]["left"]["magnification"], json["cameras"]["right"]["magnification"], 1e-9);
  EXPECT_THAT(succeed({"info", "setup", "stereo.toml"}), HasSubstr("camera right"));
}

TEST_F(InfoSetup, OfAPlenopticCameraHasItsLenslets) {
  auto const json = overview(GLADSTONE_DATA_DIR "/../studies/cases/figure1/plenoptic.toml");
  EXPECT_EQ(json["experiment"], "piv");
  EXPECT_NEAR(json["pixels_per_lenslet"], 13, 1e-9);  // 65 um over 5 um
}

TEST_F(InfoSetup, DrawsTheLayout) {
  succeed({"init", "calibration", "-o", "planes.toml"});
  for (std::string const setup : {"setup.toml", "planes.toml"}) {
    auto const json = json_of({"info", "setup", setup, "--figure", setup + ".svg", "--quiet"});
    if (!json.contains("figure")) GTEST_SKIP() << "no gnuplot here";
    EXPECT_THAT(read(setup + ".svg"), HasSubstr("<svg")) << setup;
  }
}

TEST_F(InfoSetup, NamesTheCommandThatDrawsTheLayout) {
  EXPECT_THAT(succeed({"info", "setup", "setup.toml"}),
              HasSubstr("gladstone info setup setup.toml --figure layout.png"));
}

// Pure carbon dioxide at 532 nm: Bideau-Mehu et al. (1973), 2.281e-4 m^3/kg.
TEST_F(InfoSetup, HasTheConstantOfAGas) {
  write("gas.toml", with(small_setup, "[medium.field]", "[medium.gas]\ncarbon_dioxide = 1.0\n\n[medium.field]"));
  EXPECT_NEAR(overview("gas.toml")["gladstone_dale_m3_kg"], 2.281e-4, 1e-7);
  render("case", {}, "gas.toml");
  EXPECT_EQ(nlohmann::json::parse(read("case/summary.json"))["gladstone_dale"],
            overview("gas.toml")["gladstone_dale_m3_kg"]);
  EXPECT_EQ(overview("case/setup.toml")["gladstone_dale_m3_kg"], overview("gas.toml")["gladstone_dale_m3_kg"]);
}

TEST_F(InfoSetup, RefusesBadInput) {
  write("bad.toml", with(small_setup, "f_number = 11.0", "f_number = -1"));
  expect_error({"info", "setup", "bad.toml"}, 2, "out_of_range at bad.toml:10:1");
  expect_error({"info", "setup"}, 2, "arguments at info setup");
  expect_error({"info", "setup", "setup.toml", "--figure", "setup.toml"}, 2, "overwrites_input at setup.toml");
  expect_error({"info", "setup", "setup.toml", "--figure", "layout.gif"}, 2, "output at layout.gif");
}

}  // namespace
}  // namespace gladstone::end_to_end
