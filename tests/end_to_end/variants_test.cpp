#include <cmath>

#include "tests/end_to_end/support/program_fixture.h"
#include "tests/support/numbers_in.h"

namespace gladstone::end_to_end {
namespace {

/// Other targets, sensors, apertures and media than in the small setup.
class Variants : public ProgramFixture {
 protected:
  void SetUp() override {
    ProgramFixture::SetUp();
    write("setup.toml", automatic_setup());
  }
  std::vector<double> dataset(std::string const& name, std::string const& of = "case") const {
    return Hdf5Reader(in(of + "/truth.h5").string()).read(name);
  }
  Image<double> image(std::string const& name) const { return read_image(in(name).string()); }
  static double largest(Image<double> const& picture) { return *std::max_element(picture.begin(), picture.end()); }
};

TEST_F(Variants, ChiefRaysOfAPinholeMoveByEq9InAUniformGradient) {
  render("case", {"--set", "lens.f_number=inf", "--set", "render.rays_per_dot=256"});
  auto const rays = dataset("/dots/displacement_px"), eq9 = dataset("/dots/eq9_px"),
             spread = dataset("/dots/displacement_std_px");
  ASSERT_EQ(rays.size(), eq9.size());
  // Eq. 9 is the leading order; neglected terms are of relative order theta^2 + gradient * thickness ~ 1e-5 of 0.1 px,
  // and the finite view angle (field 4 mm off axis in 1 m) is smaller
  for (std::size_t i = 0; i < rays.size(); ++i) EXPECT_NEAR(rays[i], eq9[i], 1e-5);
  // the rays are distributed over the image of the disc only: a disc of radius 1.5 px has a standard deviation of 0.75
  // px per axis, which 256 points determine to far better than 13 %
  for (double const value : spread) EXPECT_NEAR(value, 0.75, 0.1);
}

TEST_F(Variants, PointsOfATableStandWhereItSays) {
  write("dots.csv", "x_mm,y_mm\n0,0\n1.5,-0.5\r\n");
  write("points.toml", with(small_setup, "dots_per_32px_window = 10.0", "kind = \"points\"\nfile = \"dots.csv\""));
  render("case", {}, "points.toml");
  auto const position = dataset("/dots/position_m"), reference = dataset("/dots/reference_px");
  ASSERT_EQ(position.size(), 6u);
  EXPECT_NEAR(position[3], 1.5e-3, 1e-18);
  EXPECT_NEAR(position[4], -0.5e-3, 1e-18);
  // pixel (64 - 1)/2 + M x / p, rows downwards; the centroid of 32 rays of a disc is accurate to a few hundredths of a
  // pixel
  double const scale = 105.0 / 895.0 / 10e-6;
  EXPECT_NEAR(reference[2], 31.5 + 1.5e-3 * scale, 0.2);
  EXPECT_NEAR(reference[3], 31.5 + 0.5e-3 * scale, 0.2);
}

TEST_F(Variants, DotsOutsideTheViewAreWarnedOf) {
  write("dots.csv", "x_mm,y_mm\n500,0\n0,-400\n");
  write("points.toml", with(small_setup, "dots_per_32px_window = 10.0", "kind = \"points\"\nfile = \"dots.csv\""));
  auto const json = json_of({"render", "points.toml", "-o", "case"});
  EXPECT_THAT(warnings_in(json), testing::Contains("out_of_view at target"));
  EXPECT_EQ(nlohmann::json::parse(read("case/summary.json"))["warning_records"], json["warning_records"]);
  // nothing to correlate: no valid vector
  Outcome const correlated = gladstone({"correlate", "case", "--json"});
  EXPECT_EQ(correlated.exit_code, 1) << correlated.err;
  EXPECT_THAT(warnings_in(nlohmann::json::parse(correlated.out)), testing::Contains("unreliable at vectors.h5"));
}

TEST_F(Variants, RegularDotsFormALattice) {
  for (std::string const key : {"target.arrangement=regular", "target.kind=grid"}) {
    render("case", {"--set", key, "--set", "render.method=rays"});
    auto const position = dataset("/dots/position_m");
    // equal steps along the first row
    double const pitch = position[3] - position[0];
    EXPECT_GT(pitch, 0);
    EXPECT_NEAR(position[6] - position[3], pitch, 1e-15);
    EXPECT_EQ(position[1], position[4]);
  }
}

TEST_F(Variants, APictureAsTarget) {
  Image<std::uint16_t> picture(16, 16, 0);
  for (int i = 4; i < 12; ++i) picture(i, 8) = 65535;  // a horizontal bar
  write_tiff(in("bar.tif").string(), picture, {});
  write("picture.toml", with(automatic_setup(), "dots_per_32px_window = 10.0",
                             "kind = \"image\"\nfile = \"bar.tif\"\nextent_mm = [8, 8]"));
  render("case", {}, "picture.toml");
  Image<double> const seen = image("case/reference.tif");
  // 8 mm are 93.9 px: the bar, 4 mm by 0.5 mm just below the middle, extends from column 8 to 55 around row 34
  EXPECT_GT(seen(31, 34), 0.5 * largest(seen));
  EXPECT_EQ(seen(31, 10), 0);
  EXPECT_EQ(seen(2, 34), 0);
}

TEST_F(Variants, DarkDotsAreBrightOnesTakenFromWhite) {
  render("bright", {"--set", "camera.exposure=20000"});
  render("dark", {"--set", "camera.exposure=20000", "--set", "target.polarity=dark"});
  Image<double> const bright = image("bright/reference.tif"), dark = image("dark/reference.tif");
  // white paper on the axis is 20000 / 30000 of full scale; cos^4 reduces it by 4 (3.8 mm / 1 m)^2 = 6e-5, 3 levels,
  // and both images are rounded
  double const white = 20000.0 / 30000.0 * 65535;
  for (std::size_t i = 0; i < bright.size(); ++i) EXPECT_NEAR(bright.data()[i] + dark.data()[i], white, 6);
}

// A given exposure is the number of electrons in a fully lit pixel on the axis, at any f-number: white paper is as
// bright at f/5.6 as at f/22. A smaller stop reduces the light in the pixels of a dot, since its wider PSF spreads the
// light; "auto" compensates for that.
TEST_F(Variants, AGivenExposureIsThatOfAFullyLitPixelAndAutoIsThatOfTheBrightest) {
  double const white = 20000.0 / 30000.0 * 65535;
  double peak[2] = {};
  for (int const i : {0, 1}) {
    std::vector<std::string> const stop{"--set", i == 0 ? "lens.f_number=5.6" : "lens.f_number=22"};
    auto const rendered = [&](std::vector<std::string> more) {
      more.insert(more.end(), stop.begin(), stop.end());
      render("case", more);
      return largest(image("case/reference.tif"));
    };
    EXPECT_NEAR(rendered({"--set", "camera.exposure=20000", "--set", "target.polarity=dark"}), white, 6);
    EXPECT_EQ(nlohmann::json::parse(read("case/summary.json"))["exposure"], 20000);
    peak[i] = rendered({"--set", "camera.exposure=20000"});
    rendered({"--set", "render.method=rays"});
    EXPECT_NEAR(std::max(largest(image("case/reference.tif")), largest(image("case/flow.tif"))), 0.9 * 65535, 0.51);
  }
  // 3 px discs with Gaussian PSFs of sigma 0.14 and 0.55 px: 1 - exp(-r^2 / 2 sigma^2) at the centre is 1 and 0.976,
  // less the averaging by the pixel
  EXPECT_NEAR(peak[0], white, 0.01 * white);
  EXPECT_LT(peak[1], 0.99 * peak[0]);
}

TEST_F(Variants, NoiseRepeatsWithItsSeedAndDiffersBetweenFrames) {
  std::string const still =
      with(small_setup, "kind = \"uniform_gradient\"\ngradient_kg_m4 = [20.0, 10.0, 0.0]", "kind = \"none\"");
  write("noise.toml", with(still, "[lens]", "[camera.noise]\nread_noise_e = 20.0\nseed = 3\n[lens]"));
  render("a", {}, "noise.toml");
  render("b", {}, "noise.toml");
  expect_same_case("a", "b");
  render("c", {"--set", "camera.noise.seed=4"}, "noise.toml");
  auto const differing = [](Image<double> const& one, Image<double> const& other) {
    std::size_t count = 0;
    for (std::size_t i = 0; i < one.size(); ++i) count += one.data()[i] != other.data()[i];
    return count;
  };
  // read noise of 44 levels: equal values in two frames are rare, but half of the dark pixels are truncated at zero in
  // each
  EXPECT_GT(differing(image("a/reference.tif"), image("a/flow.tif")), 64u * 64u / 2);
  EXPECT_GT(differing(image("a/reference.tif"), image("c/reference.tif")), 64u * 64u / 2);
  // without medium and noise the frames are equal
  write("still.toml", still);
  render("d", {}, "still.toml");
  EXPECT_EQ(differing(image("d/reference.tif"), image("d/flow.tif")), 0u);
}

TEST_F(Variants, EightAndTwelveBitsAreStoredUnshifted) {
  write("setup.toml", small_setup);
  for (int const bits : {8, 12, 16}) {
    render("case", {"--set", "camera.bit_depth=" + std::to_string(bits)});
    ImageMetadata metadata;
    double const reference = largest(read_image(in("case/reference.tif").string(), &metadata));
    double const flow = largest(image("case/flow.tif"));
    double const full_scale = std::pow(2.0, bits) - 1;
    EXPECT_EQ(metadata.bit_depth, bits);
    EXPECT_NEAR(metadata.pixel_pitch_m, 10e-6, 1e-9);
    EXPECT_NE(metadata.description.find("bit_depth = " + std::to_string(bits)), std::string::npos);
    EXPECT_NEAR(std::max(reference, flow), 0.9 * full_scale, 0.51);  // auto exposure, rounded
  }
}

/// A density ramp of 20 kg/m^4 along x, relative to the ambient density, as a volume and as a plane.
class FieldFiles : public Variants {
 protected:
  static constexpr int side = 17, depth = 5;  // nodes, 0.5 and 2.5 mm apart: 8 mm by 10 mm
  static float ramp(int i) { return 1.225f + 20.0f * 0.5e-3f * static_cast<float>(i - side / 2); }
  std::string setup(std::string const& file, std::string const& more) const {
    return with(automatic_setup(), "kind = \"uniform_gradient\"\ngradient_kg_m4 = [20.0, 10.0, 0.0]",
                "kind = \"file\"\nfile = \"" + file + "\"\n" + more);
  }
  /// The ramp as a volume, ramp.nrrd, of 8 mm across.
  void write_volume() const {
    std::string data =
        "NRRD0004\ntype: float\ndimension: 3\nsizes: 17 17 5\nendian: little\nencoding: raw\nspacings: 0.5 0.5 2.5\n\n";
    for (int k = 0; k < depth; ++k) {
      for (int j = 0; j < side; ++j) {
        for (int i = 0; i < side; ++i) {
          float const value = ramp(i);
          data.append(reinterpret_cast<char const*>(&value), sizeof value);
        }
      }
    }
    write("ramp.nrrd", data);
  }
  void expect_the_ramp(std::string const& name, std::string const& text) const {
    write("ramp.toml", text);
    render(name, {}, "ramp.toml");
    // the same gradient in closed form, ray by ray; floats of 1.2 kg/m^3 have an error of 6e-8, and differences of 20
    // kg/m^4 over 0.5 mm of 1e-5
    render("exact", {"--set", "medium.field.gradient_kg_m4=[20.0, 0.0, 0.0]"});
    auto const u = dataset("/dots/displacement_px", name), exact = dataset("/dots/displacement_px", "exact");
    auto const position = dataset("/dots/position_m", name);
    ASSERT_EQ(u.size(), exact.size());
    for (std::size_t dot = 0; dot < u.size() / 2; ++dot) {
      // rays pass the medium within 3/4 of the dot's distance from the axis plus 1.2 mm of cone, an eighth of it and
      // the size of the dot; within two cells of the edge of the field the truth is an average over 32 rays, some of
      // which pass the stop in one frame only
      double const reach = 0.75 * std::max(std::abs(position[3 * dot]), std::abs(position[3 * dot + 1])) + 1.5e-3;
      if (reach < 4e-3) {
        double const tolerance = reach < 3e-3 ? 2e-5 : 0.1;
        EXPECT_NEAR(u[2 * dot], exact[2 * dot], tolerance * std::abs(exact[2 * dot]) + 1e-7);
      }
    }
  }
};

TEST_F(FieldFiles, NrrdVolumeBendsAsTheGradientItHolds) {
  write_volume();
  expect_the_ramp("case", setup("ramp.nrrd", ""));
}

// A volume 4 mm wide in a view of 4.09 mm at its depth: its faces cut the cones of dots on all sides. One warning
// states the error of the truth with 32 rays for each of these dots, that "auto" exposure depends on them, and the
// remedy.
TEST_F(FieldFiles, FacesInViewCauseAWarningWithTheErrorOfTheTruth) {
  write_volume();
  write("faces.toml", setup("ramp.nrrd", "spacing_mm = [0.25, 0.25, 2.5]"));
  auto const rendered = [&](std::vector<std::string> const& more) {
    std::vector<std::string> arguments{"render", "faces.toml", "-o", "case"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    Outcome const outcome = gladstone(arguments);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.err;
    return nlohmann::json::parse(read("case/summary.json"));
  };
  auto const of_faces = [](nlohmann::json const& summary) {
    std::string found;
    for (nlohmann::json const& warning : summary["warning_records"]) {
      if (warning["place"] == "render.rays_per_dot") found = warning["text"];
    }
    return found;
  };
  auto const summary = rendered({});
  EXPECT_THAT(of_faces(summary),
              testing::AllOf(ContainsWhole("32 rays"), ContainsWhole("0.001"), testing::HasSubstr("camera.exposure"),
                             testing::HasSubstr("render.rays_per_dot = \"auto\"")));
  auto const& faces = summary["estimator"]["side_faces"];
  EXPECT_GT(faces["dots"], 4);
  EXPECT_EQ(faces["rays"], 32);
  EXPECT_GT(faces["truth_error_px"], 1e-3);
  // Above the goal of half a level, since 32 rays scatter more than that. Only the light of these dots is traced ray by
  // ray.
  EXPECT_GT(summary["image_error"]["levels"], 0.5);
  EXPECT_THAT(warnings_in(summary), testing::Not(testing::Contains("low_accuracy at images")));
  EXPECT_THAT(of_faces(rendered({"--set", "camera.exposure=20000"})),
              testing::AllOf(ContainsWhole("32 rays"), testing::Not(testing::HasSubstr("camera.exposure"))));
}

TEST_F(FieldFiles, AnIndexInSinglePrecisionIsWarnedOfInTheSummary) {
  std::string data =
      "NRRD0004\ntype: float\ndimension: 2\nsizes: 17 17\nendian: little\nencoding: raw\nspacings: 0.5 0.5\n\n";
  for (int i = 0; i < side * side; ++i) {
    float const value = 1.0f + 2.26e-4f * ramp(i % side);
    data.append(reinterpret_cast<char const*>(&value), sizeof value);
  }
  write("n.nrrd", data);
  write("n.toml", setup("n.nrrd", "extrude = true\nquantity = \"refractive_index\""));
  render("case", {}, "n.toml");
  EXPECT_THAT(warnings_in(nlohmann::json::parse(read("case/summary.json"))),
              testing::Contains("low_accuracy at medium.field.quantity"));
}

TEST_F(FieldFiles, Hdf5PlaneExtrudedBendsAsTheGradientItHolds) {
  std::vector<double> values;
  for (int j = 0; j < side; ++j) {
    for (int i = 0; i < side; ++i) values.push_back(ramp(i));
  }
  Hdf5Writer file(in("ramp.h5").string(), {"test field", 1, "", 0, "cpu"});
  file.write("rho", values, {1, side, side, 1}, "kg/m^3", "ramp along x", "z, y, x, component");
  file.close();
  expect_the_ramp("case", setup("ramp.h5", "extrude = true\nspacing_mm = [0.5, 0.5, 0.5]"));
}

TEST_F(Variants, OddButPossibleSetupsRender) {
  for (std::vector<std::string> const& odd :
       {std::vector<std::string>{"camera.pixels=[4, 4]", "correlate.window_px=[4]"},
        {"camera.pixels=[200, 33]"},
        {"render.rays_per_dot=1"},
        {"target.dots_per_32px_window=0.1"},
        {"target.dot_diameter_px=0"},
        {"medium.thickness_mm=1e-9"},
        {"correlate.overlap=0.95", "render.method=rays"},
        {"camera.bit_depth=1"},
        {"camera.exposure=1e30", "camera.noise.shot_noise=true", "render.method=rays"},
        {"lens.focus=medium"},
        {"lens.psf=airy"},
        {"lens.psf=none"},
        {"medium.step_mm=1e300"}}) {
    std::vector<std::string> arguments;
    for (auto const& key : odd) arguments.insert(arguments.end(), {"--set", key});
    render("case", arguments);
    for (double const pixel : image("case/flow.tif")) ASSERT_TRUE(pixel >= 0 && pixel <= 65535) << odd.front();
    for (double const value : dataset("/dots/eq9_px")) ASSERT_TRUE(std::isfinite(value)) << odd.front();
  }
}

// The truth of a dot at the faces of a volume comes from its rays only; one rendering reports its accuracy and the
// remedy.
TEST_F(Variants, WarnsOfInaccurateTruth) {
  auto const json = json_of(
      {"render", "setup.toml", "-o", "case", "--set", "lens.focus=medium", "--set", "camera.noise.read_noise_e=3"});
  EXPECT_THAT(warnings_in(json), testing::IsSupersetOf({"low_accuracy at truth", "unsuitable at camera.offset_dn"}));
  EXPECT_THAT(json["warnings"].dump(), ContainsWhole("6.55 grey levels"));
  for (nlohmann::json const& warning : json["warning_records"]) {
    if (warning["code"] != "low_accuracy" || warning["place"] != "truth") continue;
    EXPECT_EQ(numbers_in(warning["text"]).size(), 7u)
        << "the number of dots whose truth is computed from rays only is omitted if it applies to all dots: "
        << warning;
  }
  auto const summary = nlohmann::json::parse(read("case/summary.json"));
  double const rms = summary["truth_error_px"]["rms"];
  EXPECT_GT(rms, 1e-3);
  EXPECT_GE(summary["truth_error_px"]["largest"], rms);
  EXPECT_GT(summary["truth_error_px"]["dots_above_1e-3"], 0);
  EXPECT_EQ(summary["estimator"]["dots_by_table"], 0);
  EXPECT_EQ(summary["estimator"]["no_table_since"], "dots are rendered ray by ray (method = \"rays\")");
  double square = 0;
  std::vector<double> const errors = dataset("/dots/displacement_error_px");
  for (double const error : errors) square += error * error / static_cast<double>(errors.size());
  EXPECT_NEAR(std::sqrt(square), rms, 1e-9 * rms);

  // in focus a table has a much smaller error for this field, and there is no warning
  EXPECT_THAT(warnings_in(json_of({"render", "setup.toml", "-o", "focused"})),
              testing::Not(testing::Contains("low_accuracy at truth")));
  auto const better = nlohmann::json::parse(read("focused/summary.json"));
  EXPECT_LT(better["truth_error_px"]["largest"], 1e-4);
  EXPECT_EQ(better["estimator"]["dots_by_rays"], 0);
  EXPECT_EQ(better["estimator"]["no_table_since"], "");
  for (double const by_table : dataset("/dots/by_table", "focused")) EXPECT_EQ(by_table, 1);
}

// The wider the pupil, the steeper the rays, and the larger their deflection by the medium.
TEST_F(Variants, GradientsThatBendRaysPastAnyLensAreRefused) {
  for (std::string const steep : {"[0, -1e5, 0]", "[3e5, 0, 0]"}) {
    std::string const method = steep[1] == '0' ? "rays" : "focused_dots";
    Outcome const outcome = gladstone({"render", "setup.toml", "-o", "case", "--set", "render.method=" + method,
                                       "--set", "medium.field.gradient_kg_m4=" + steep, "--json"});
    EXPECT_EQ(outcome.exit_code, 2) << steep;
    expect_error_in(outcome, "out_of_range at medium.field");
    EXPECT_FALSE(std::filesystem::exists(in("case")));
  }
}

// A dot 1.2 m off the axis, which the mounts of a double Gauss lens vignette completely, and one on the axis.
TEST_F(Variants, DotsThatTheLensVignettesAreNotBlamedOnTheFlow) {
  write("dots.csv", "x_mm,y_mm\n0,0\n1200,0\n");
  write("points.toml", R"(schema = 1
[camera]
pixels = [64, 64]
[lens]
model = "prescription"
file = ")" + std::string(GLADSTONE_DATA_DIR) +
                           R"(/lenses/double_gauss.toml"
f_number = 8.0
[geometry]
z_a_mm = 1000.0
z_d_mm = 100.0
[target]
kind = "points"
file = "dots.csv"
[medium]
thickness_mm = 10.0
[medium.field]
kind = "none"
[render]
rays_per_dot = 64
)");
  auto const json = json_of({"render", "points.toml", "-o", "case"});
  EXPECT_EQ(json["dots_unseen"], 1);
  EXPECT_THAT(warnings_in(json), testing::Contains("out_of_view at target").Times(1));
  for (nlohmann::json const& warning : json["warning_records"]) {
    if (warning["code"] != "out_of_view") continue;
    EXPECT_EQ(numbers_in(warning["text"]).size(), 3u) << "unseen dots, dots and rays, but no deflection: " << warning;
  }
}

TEST_F(Variants, ReportsDotsHiddenByExcessiveGradients) {
  auto const json = json_of({"render", "setup.toml", "-o", "case", "--set", "medium.field.gradient_kg_m4=[5e4, 0, 0]",
                             "--set", "render.method=rays"});
  EXPECT_THAT(warnings_in(json),
              testing::IsSupersetOf({"out_of_view at target", "implausible at medium.field.gradient_kg_m4"}));
  EXPECT_THAT(json["warnings"].dump(), ContainsWhole("32 rays"));
}

}  // namespace
}  // namespace gladstone::end_to_end
