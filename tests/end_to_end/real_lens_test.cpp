#include <cmath>

#include "render/base/units.h"
#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::HasSubstr;

/// Scenes beyond the thin lens on the axis: rendered ray by ray, through the whole chain.
class RealLens : public ProgramFixture {
 protected:
  nlohmann::json summary_of(std::string const& folder) const {
    return nlohmann::json::parse(read(folder + "/summary.json"));
  }
  /// Renders, correlates, compares. @return errors.json
  nlohmann::json compared(std::string const& folder, std::string const& setup,
                          std::vector<std::string> const& more = {}) const {
    render(folder, more, setup);
    succeed({"correlate", folder});
    succeed({"compare", folder, "--no-figures"});
    return nlohmann::json::parse(read(folder + "/errors.json"));
  }
  static double rms(nlohmann::json const& errors, char const* term) {
    return errors["budget"]["terms"][term]["rms_px"].get<double>();
  }
};

std::string double_gauss_setup() {
  return with(automatic_setup(), "focal_length_mm = 105.0\nf_number = 11.0",
              "model = \"prescription\"\nfile = \"" + std::string(GLADSTONE_DATA_DIR) +
                  "/lenses/double_gauss.toml\"\nf_number = 8.0");
}

// A double Gauss in place of the thin lens: rendered ray by ray, and its difference from an ideal lens is a term of the
// budget.
TEST_F(RealLens, RunsThroughTheWholeChain) {
  write("lens.toml", with(double_gauss_setup(), "rays_per_dot = 32", "rays_per_dot = 256"));
  auto const errors = compared("case", "lens.toml");
  auto const summary = summary_of("case");
  EXPECT_EQ(summary["method"], "rays");
  EXPECT_EQ(Hdf5Reader(in("case/truth.h5").string()).attribute("method"), "rays");
  // f / (Z_B - f) for 99.8 mm at 532 nm, to the difference between best and paraxial focus
  EXPECT_NEAR(summary["magnification"].get<double>(), 0.111, 0.001);
  EXPECT_GT(rms(errors, "aberration"), 1e-7);
  EXPECT_LT(rms(errors, "aberration"), 0.01);
  EXPECT_LT(errors["budget"]["closure_px"].get<double>(), 1e-9);
  EXPECT_LT(errors["ray_truth"]["rms_px"].get<double>(), 0.05);
  // the resolved setup gives the same case
  render("again", {}, "case/setup.toml");
  expect_same_case("case", "again");
}

// One glass of the double Gauss is in several catalogues: its origin is printed as by info lens.
TEST_F(RealLens, NamesTheCatalogueOfAGlassThatSeveralContain) {
  write("lens.toml", double_gauss_setup());
  std::string const listed = succeed({"info", "lens", std::string(GLADSTONE_DATA_DIR) + "/lenses/double_gauss.toml"});
  std::size_t const at = listed.find("also in ");
  ASSERT_NE(at, std::string::npos);
  std::string const also = listed.substr(at, listed.find('\n', at) - at);
  EXPECT_THAT(succeed({"render", "lens.toml", "-o", "case"}), HasSubstr("(" + also + ")"));
}

// An object-space telecentric lens, positioned by its first vertex: a gas with a uniform gradient deflects light by
// eps, which displaces the dots by M Z_D eps / p, where M is the magnification of the lens at the distance of the dots,
// regardless of the elements in between.
TEST_F(RealLens, TelecentricOneRunsThroughTheWholeChain) {
  std::string const lens = "model = \"prescription\"\nfile = \"" + std::string(GLADSTONE_DATA_DIR) +
                           "/lenses/telecentric.toml\"\nf_number = 11.0";
  write("lens.toml", with(with(with(automatic_setup(), "focal_length_mm = 105.0\nf_number = 11.0", lens),
                               "z_a_mm = 750.0\nz_d_mm = 250.0", "z_front_mm = 960.0\nz_d_mm = 200.0"),
                          "rays_per_dot = 32", "rays_per_dot = 256"));
  auto const errors = compared("case", "lens.toml");
  auto const summary = summary_of("case");
  EXPECT_EQ(summary["method"], "rays");
  double const M = summary["magnification"];
  EXPECT_NEAR(M, 0.2, 0.004);
  EXPECT_LT(errors["ray_truth"]["rms_px"].get<double>(), 0.05);
  EXPECT_LT(errors["budget"]["closure_px"].get<double>(), 1e-9);
  auto const displacement = Hdf5Reader(in("case/truth.h5").string()).read("/dots/displacement_px");
  double const K = 2.26e-4, n0 = 1 + K * 1.225, scale = M * 0.2 * K * 0.01 / n0 / 10e-6;
  double u = 0, v = 0;
  auto const count = static_cast<double>(displacement.size() / 2);
  for (std::size_t k = 0; k < displacement.size() / 2; ++k) {
    u += displacement[2 * k] / count;
    v += displacement[2 * k + 1] / count;
  }
  // dots scatter by 1 % with 256 rays, the mean over some hundred dots by a tenth of that; distortion adds 0.1 %
  EXPECT_NEAR(u / (-20 * scale), 1, 4e-3);
  EXPECT_NEAR(v / (10 * scale), 1, 4e-3);
}

// A plenoptic camera: the image consists of lenslet images, each showing the stop; its total light is that collected by
// the lens alone.
TEST_F(RealLens, LensletsSortTheLightOfTheWholePicture) {
  std::string const plain = with(automatic_setup(), "[lens]", "[camera.sensor]\ntilt_deg = [0.0, 0.0]\n[lens]");
  std::string const exposed =
      with(with(plain, "pixel_pitch_um = 10.0", "pixel_pitch_um = 10.0\nexposure = 20000.0"),
           "dots_per_32px_window = 10.0", "kind = \"points\"\nfile = \"points.csv\"\ndot_diameter_mm = 0.2");
  write("points.csv", "x_mm,y_mm\n0,0\n0.9,-0.7\n-1.1,1.2\n-0.8,-1.3\n1.3,0.9\n");
  write("plain.toml", exposed);
  write("plenoptic.toml", with(exposed, "[lens]",
                               "[camera.lenslets]\npitch_um = 80.0\nfocal_length_um = 900.0\n"
                               "layout = \"hexagonal\"\n[lens]"));
  render("plain", {"--set", "render.method=rays", "--set", "render.rays_per_dot=4096"}, "plain.toml");
  render("plenoptic", {"--set", "render.rays_per_dot=4096"}, "plenoptic.toml");
  EXPECT_EQ(summary_of("plenoptic")["method"], "rays");
  auto const light = [this](std::string const& folder) {
    double sum = 0;
    for (double const level : read_image(in(folder + "/reference.tif").string())) sum += level;
    return sum;
  };
  // enough rays of dots in the middle of the image; a fully lit pixel, for which the exposure is defined, sees (1 + d /
  // z_i)^2 less of the target, d = 0.9 mm behind the image at 117.3 mm. Rounding of 4096 levels, compared with some 1e6
  // in total
  EXPECT_NEAR(light("plenoptic") / light("plain"), std::pow(1 + 0.9 / 117.3184, 2), 1e-3);
  render("again", {}, "plenoptic/setup.toml");
  expect_same_case("plenoptic", "again");
}

// The lens has a wide aperture and a wider field: it has more aberrations.
TEST_F(RealLens, AberratesMoreWideOpen) {
  write("lens.toml", double_gauss_setup());
  double const narrow = rms(compared("narrow", "lens.toml", {"--set", "lens.f_number=16"}), "aberration");
  double const wide = rms(compared("wide", "lens.toml", {"--set", "lens.f_number=2.8"}), "aberration");
  EXPECT_GT(wide, 2 * narrow);
}

TEST_F(RealLens, TracesGivenRays) {
  write("lens.toml", with(double_gauss_setup(), "kind = \"uniform_gradient\"\ngradient_kg_m4 = [20.0, 10.0, 0.0]",
                          "kind = \"none\""));
  write("rays.csv", "x_mm,y_mm,z_mm,dx,dy,dz\n0,0,-250,0,0,1\n0,0,-250,1,0,1\n0,0,-20,0,0,-1\n");
  for (std::string const through : {"optics", "all"}) {
    succeed({"trace", "lens.toml", "--rays", "rays.csv", "-o", through + ".csv", "--through", through});
  }
  std::string const optics = read("optics.csv"), all = read("all.csv");
  EXPECT_THAT(optics, HasSubstr("alive,0,0,"));
  EXPECT_THAT(optics, HasSubstr("missed_lens,nan"));
  EXPECT_THAT(all, HasSubstr("alive,0,0,"));
  EXPECT_THAT(all, HasSubstr(",31.5,31.5\n"));
  // the second ray misses the lens, the third points away from it
  for (std::string const& rows : {optics, all}) {
    EXPECT_THAT(rows, HasSubstr("missed_lens,nan,nan,nan,nan,nan,nan,nan,nan,nan\nmissed_lens,nan"));
  }
}

// Both methods give the same case to within the accuracy of their rays; the setup may select either.
TEST_F(RealLens, MethodsAgreeOnTheBench) {
  write("setup.toml", automatic_setup());
  auto const fast = compared("fast", "setup.toml"),
             rays =
                 compared("rays", "setup.toml", {"--set", "render.method=rays", "--set", "render.rays_per_dot=2048"});
  EXPECT_EQ(summary_of("fast")["method"], "focused_dots");
  EXPECT_EQ(summary_of("rays")["method"], "rays");
  EXPECT_EQ(Hdf5Reader(in("fast/truth.h5").string()).attribute("method"), "focused_dots");
  for (char const* term : {"small_angle", "cone", "refraction"}) {
    EXPECT_NEAR(rms(rays, term), rms(fast, term), 1e-4) << term;
  }
  EXPECT_LT(rms(rays, "aberration"), 1e-9) << "an ideal lens in focus";
  EXPECT_NEAR(rays["ray_truth"]["rms_px"].get<double>(), fast["ray_truth"]["rms_px"].get<double>(), 2e-3);
}

TEST_F(RealLens, MethodThatDoesNotHoldIsRefused) {
  expect_error(
      {"render", "setup.toml", "-o", "case", "--set", "render.method=focused_dots", "--set", "lens.focus=medium"}, 2,
      "invalid_value at --set render.method=focused_dots");
  expect_error({"render", "setup.toml", "-o", "case", "--set", "render.method=fast"}, 2,
               "unknown_choice at --set render.method=fast");
}

// A camera with an oblique view of the dots, its sensor tilted so that they are in focus, through an optical window:
// every vector is correct, and the effects of the window and the tilted lens count as aberration.
TEST_F(RealLens, LooksFromTheSideThroughAWindow) {
  std::string const posed = with(with(automatic_setup(), "z_a_mm = 750.0\n", ""), "[lens]",
                                 "[camera.pose]\nposition_mm = [250.0, 0.0, 700.0]\nlook_at_mm = [0.0, 0.0, 0.0]\n"
                                 "[camera.sensor]\nscheimpflug = \"auto\"\n"
                                 "[[window]]\nthickness_mm = 10.0\nposition_mm = [0.0, 0.0, 50.0]\n[lens]");
  write("posed.toml", with(posed, "rays_per_dot = 32", "rays_per_dot = 128"));
  auto const errors = compared("case", "posed.toml");
  EXPECT_EQ(summary_of("case")["method"], "rays");
  EXPECT_LT(errors["ray_truth"]["rms_px"].get<double>(), 0.05);
  EXPECT_LT(errors["budget"]["closure_px"].get<double>(), 1e-9);
  // along the line of sight the medium is thicker, and its gradient is seen at an angle: still within a tenth of Eq. 9
  EXPECT_LT(rms(errors, "small_angle"), 0.05);
  render("again", {}, "case/setup.toml");
  expect_same_case("case", "again");
}

// A thin prism between medium and lens, at the distance b = 850 mm from the dots, displaces all images by the fraction
// b / Z_B of its deflection (n - 1) a times z_i / p; a tilted plate between lens and sensor displaces them by t sin(a)
// (1 - cos(a) / sqrt(n^2 - sin(a)^2)) / p. Neither changes the displacement by the medium, M Z_D K L grad rho / (n0 p),
// which the correlation measures.
TEST_F(RealLens, PrismAndPlateDisplaceBothImages) {
  write("setup.toml", with(automatic_setup(), "rays_per_dot = 32", "rays_per_dot = 256") +
                          "[[element]]\nkind = \"wedge\"\nthickness_mm = 0.5\nposition_mm = [0.0, 0.0, 600.0]\n"
                          "wedge_deg = [0.0, 0.1]\n[[element]]\nkind = \"window\"\nside = \"sensor\"\n"
                          "thickness_mm = 1.0\nposition_mm = [0.0, 0.0, 50.0]\ntilt_deg = [20.0, 0.0]\n");
  auto const errors = compared("case", "setup.toml");
  EXPECT_LT(errors["ray_truth"]["rms_px"].get<double>(), 0.05);
  EXPECT_LT(errors["budget"]["closure_px"].get<double>(), 1e-9);
  EXPECT_LT(rms(errors, "small_angle"), 0.05);
  Hdf5Reader const truth(in("case/truth.h5").string());
  auto const position = truth.read("/dots/position_m"), image = truth.read("/dots/reference_px");
  auto const displacement = truth.read("/dots/displacement_px");
  double const n = 1.519472583, pitch = 10e-6, M = 0.105 / (1 - 0.105), degree = pi / 180;
  double right = 0, up = 0, u = 0, v = 0;
  std::size_t const dots = image.size() / 2;
  auto const count = static_cast<double>(dots);
  for (std::size_t k = 0; k < dots; ++k) {
    right += (image[2 * k] - 31.5 - M * position[3 * k] / pitch) / count;
    up += (31.5 - image[2 * k + 1] - M * position[3 * k + 1] / pitch) / count;
    u += displacement[2 * k] / count;
    v += displacement[2 * k + 1] / count;
  }
  // The prism is 0.5 mm thick, which changes b by 2e-4 of it; the plate changes the angle of oblique rays, which is at
  // most 6e-3 and averages out over the dots to less than a tenth of that.
  EXPECT_NEAR(right / (0.85 * (n - 1) * 0.1 * degree * M / pitch), 1, 2e-3);
  double const s = std::sin(20 * degree), c = std::cos(20 * degree);
  EXPECT_NEAR(std::abs(up) / (1e-3 * s * (1 - c / std::sqrt(n * n - s * s)) / pitch), 1, 5e-3);
  double const K = 2.26e-4, scale = M * 0.25 * K * 0.01 / (1 + K * 1.225) / pitch;
  EXPECT_NEAR(u / (-20 * scale), 1, 4e-3);
  EXPECT_NEAR(v / (10 * scale), 1, 4e-3);
  render("again", {}, "case/setup.toml");
  expect_same_case("case", "again");
}

}  // namespace
}  // namespace gladstone::end_to_end
