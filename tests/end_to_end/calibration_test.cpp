#include <algorithm>
#include <cmath>

#include "analysis/calibration/pinhole_fit.h"
#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

namespace fs = std::filesystem;

/// A 24 mm lens 300 mm in front of dots 1 mm wide, on three planes 40 mm apart.
constexpr char const* wide = R"(experiment = "calibration"

[camera]
pixels = [640, 480]
pixel_pitch_um = 10.0
bit_depth = 12
offset_dn = 50
[camera.noise]
read_noise_e = 5.0

[lens]
focal_length_mm = 24.0
f_number = 11.0

[geometry]
z_a_mm = 300.0

[calibration]
planes_mm = [-20.0, 0.0, 20.0]
spacing_mm = 5.0
dot_diameter_mm = 1.5
extent_mm = [60.0, 45.0]

[render]
rays_per_dot = 1024
)";

class Calibrations : public ProgramFixture {
 protected:
  std::vector<double> dataset(std::string const& file, std::string const& name) const {
    return Hdf5Reader(in(file).string()).read(name);
  }
  nlohmann::json calibrate(std::string const& folder) const {
    return json_of({"calibrate", folder, "--quiet", "--no-figures"});
  }
  /// Every parameter is within three standard errors of that of the camera that rendered the images.
  static void expect_recovered(nlohmann::json const& calibration) {
    for (auto const& [name, parameter] : calibration["pinhole"]["parameters"].items()) {
      double const off = parameter["value"].get<double>() - parameter["rendered"].get<double>();
      EXPECT_LT(std::abs(off), 3 * parameter["standard_error"].get<double>()) << name << "\n" << parameter;
    }
  }
};

TEST_F(Calibrations, RenderPlanesOfDotsAndTheirTruth) {
  write("setup.toml", wide);
  auto const json = json_of({"render", "setup.toml", "-o", "case", "--quiet"});
  EXPECT_EQ(names("case"), (std::vector<std::string>{"plane_000.tif", "plane_001.tif", "plane_002.tif", "setup.toml",
                                                     "summary.json", "truth.h5"}));
  EXPECT_EQ(json["planes"].size(), 3u);
  EXPECT_EQ(json["dots"], 3 * 13 * 9);
  auto const position = dataset("case/truth.h5", "/dots/position_m"),
             image = dataset("case/truth.h5", "/dots/image_px"), chief = dataset("case/truth.h5", "/dots/chief_px");
  ASSERT_EQ(position.size(), 3u * 3 * 13 * 9);
  // a thin lens in focus on Z = 0: z_i = f (z_a) / (z_a - f), pixel = middle + z_i / p times (x, -y) / (z_a - z)
  double const scale = 24e-3 * 0.3 / (0.3 - 24e-3) / 10e-6;
  for (std::size_t k = 0; k < position.size() / 3; ++k) {
    double const depth = 0.3 - position[3 * k + 2];
    double const column = 319.5 + scale * position[3 * k] / depth, row = 239.5 - scale * position[3 * k + 1] / depth;
    EXPECT_NEAR(chief[2 * k], column, 1e-7);
    EXPECT_NEAR(chief[2 * k + 1], row, 1e-7);
    // centroids: 1024 random rays over 13 px would scatter by 13 / 4 / sqrt(1024) = 0.1 px, those of a Sobol sequence
    // by a tenth of that
    EXPECT_NEAR(image[2 * k], column, 0.05);
    EXPECT_NEAR(image[2 * k + 1], row, 0.05);
  }
}

// Error of the positions due to the finite number of rays: the difference between two tracings equals the actual error,
// since the true positions have a closed form for a thin lens in focus. Fewer rays have a larger error and cause a
// warning.
TEST_F(Calibrations, ReportPositionErrorDueToRays) {
  write("setup.toml", wide);
  auto const json = json_of({"render", "setup.toml", "-o", "case", "--quiet"});
  auto const image = dataset("case/truth.h5", "/dots/image_px"), chief = dataset("case/truth.h5", "/dots/chief_px");
  for (std::size_t plane = 0; plane < 3; ++plane) {
    EXPECT_EQ(json["planes"][plane]["rays_planned"], 1024);
    double squares = 0;
    for (std::size_t k = 2 * 117 * plane; k < 2 * 117 * (plane + 1); ++k) squares += std::pow(image[k] - chief[k], 2);
    double const missed = std::sqrt(squares / (2 * 117)), said = json["planes"][plane]["place_error_px"]["rms"];
    // 128 numbers determine a scatter to 1 / sqrt(2 * 128) = 6 %. In focus all rays of a point meet whatever their
    // number, and the remaining error is cos^4 across a dot, which is part of its position
    EXPECT_LT(said, 1.25 * missed) << plane;
    if (plane != 1) {
      EXPECT_GT(said, 0.75 * missed) << plane;
    }
  }
  auto const few = json_of({"render", "setup.toml", "-o", "few", "--quiet", "--set", "render.rays_per_dot=64"});
  EXPECT_GT(few["planes"][0]["place_error_px"]["rms"], 2 * json["planes"][0]["place_error_px"]["rms"].get<double>());
  EXPECT_THAT(warnings_in(few), testing::Contains("low_accuracy at render.rays_per_dot"));
}

// With "auto", each dot takes the rays that its image requires for half a grey level. They suffice for positions to
// the goal of every truth, 1e-3 px, and the written setup renders the same images.
TEST_F(Calibrations, AutoTakesTheRaysThatImagesRequire) {
  std::string const given = wide;
  write("setup.toml", given.substr(0, given.find("[render]")));
  auto const json = json_of({"render", "setup.toml", "-o", "case", "--quiet"});
  for (auto const& plane : json["planes"]) {
    EXPECT_LT(plane["place_error_px"]["rms"], 1e-3) << plane;
    EXPECT_LE(plane["rays_planned"], json["rays_per_dot"]) << plane;
  }
  EXPECT_THAT(warnings_in(json), testing::Not(testing::Contains("low_accuracy at render.rays_per_dot")));
  auto const again = json_of({"render", "case/setup.toml", "-o", "again", "--quiet"});
  for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(again["planes"][i]["sha256"], json["planes"][i]["sha256"]) << i;
}

// A double Gauss lens with a grid of +-1.2 m at a distance of 1 m: its mounts vignette dots far from the axis
// completely.
TEST_F(Calibrations, WarnOfDotsThatTheLensVignettes) {
  write("setup.toml", R"(experiment = "calibration"
[camera]
pixels = [128, 128]
pixel_pitch_um = 100.0
[lens]
model = "prescription"
file = ")" + std::string(GLADSTONE_DATA_DIR) +
                          R"(/lenses/double_gauss.toml"
f_number = 8.0
[geometry]
z_a_mm = 1000.0
[calibration]
planes_mm = [0.0, 10.0]
spacing_mm = 200.0
dot_diameter_mm = 10.0
extent_mm = [2400.0, 2400.0]
[render]
rays_per_dot = 64
)");
  auto const json = json_of({"render", "setup.toml", "-o", "case", "--quiet"});
  std::string const warnings = json["warnings"].dump();
  for (auto const& plane : json["planes"]) {
    int const unseen = plane["dots_unseen"];
    EXPECT_GT(unseen, 0);
    EXPECT_THAT(warnings, testing::HasSubstr(std::to_string(unseen) + " of 169 "));
  }
  EXPECT_THAT(warnings_in(json), testing::Contains("out_of_view at target").Times(2))
      << "by the lens, not by the medium";
}

TEST_F(Calibrations, RecoverTheCamera) {
  write("setup.toml", wide);
  render("case");
  auto const json = calibrate("case");
  EXPECT_EQ(json["dots"], 3 * 13 * 9);
  expect_recovered(json);
  EXPECT_LT(json["pinhole"]["rms_px"].get<double>(), 0.01);
  EXPECT_LT(json["soloff"]["rms_px"].get<double>(), 0.1);
  EXPECT_EQ(dataset("case/calibration.h5", "/pinhole/camera_matrix")[0], json["pinhole"]["parameters"]["fx"]["value"]);
  EXPECT_EQ(dataset("case/calibration.h5", "/soloff/exponents").size(), 19u * 3);
}

// The detected positions are the centroids of the light.
TEST_F(Calibrations, DetectionAgreesWithTheTruth) {
  write("setup.toml", wide);
  render("case");
  calibrate("case");
  auto const truth = dataset("case/truth.h5", "/dots/image_px"),
             seen = dataset("case/calibration.h5", "/dots/image_px");
  auto const index = dataset("case/calibration.h5", "/dots/index"),
             plane = dataset("case/calibration.h5", "/dots/plane");
  double squares = 0;
  std::size_t const count = plane.size();
  for (std::size_t k = 0; k < count; ++k) {
    auto const dot = static_cast<std::size_t>(plane[k] * 117 + (index[2 * k + 1] + 4) * 13 + index[2 * k] + 6);
    for (std::size_t axis = 0; axis < 2; ++axis) {
      double const error = seen[2 * k + axis] - truth[2 * dot + axis];
      EXPECT_LT(std::abs(error), 0.02) << k;
      squares += error * error;
    }
  }
  EXPECT_LT(std::sqrt(squares / (2.0 * static_cast<double>(count))), 5e-3);
}

// Brown's coefficients, and thereby the whole image to 0.01 px: the fitted camera and the one that rendered the images
// project the points of all planes, and of planes between them, to the same pixels. With noise of some 0.005 px in each
// of 351 dots, fourteen parameters retain sqrt(14 / 702) of it on average, and a few times that in the corners.
TEST_F(Calibrations, RecoverDistortion) {
  write("setup.toml", with(wide, "[lens]", "[camera.sensor]\ndistortion = [-0.2, 0.1, 0.002, -0.001]\n[lens]"));
  render("case");
  auto const json = calibrate("case");
  expect_recovered(json);
  auto const camera = [&](char const* which) {
    PinholeCamera of;
    for (std::size_t i = 0; i < PinholeCamera::count; ++i) {
      of.value[i] = json["pinhole"]["parameters"][PinholeCamera::names[i]][which].get<double>();
    }
    return of;
  };
  PinholeCamera const fitted = camera("value"), rendered = camera("rendered");
  PinholeCamera without = rendered;
  for (std::size_t i = 4; i < 8; ++i) without.value[i] = 0;
  double most = 0, distorted = 0;
  for (double const z : {-20e-3, -10e-3, 0.0, 10e-3, 20e-3}) {
    for (double x = -30e-3; x <= 30.1e-3; x += 5e-3) {
      for (double y = -20e-3; y <= 20.1e-3; y += 5e-3) {
        Vec2d const there = rendered.project({x, y, z});
        most = std::max(most, length(fitted.project({x, y, z}) - there));
        distorted = std::max(distorted, length(without.project({x, y, z}) - there));
      }
    }
  }
  EXPECT_LT(most, 0.01);
  // Brown's formula gives 1.36 px in the nearest corner, at 30 and 20 mm of the plane 280 mm from the lens.
  EXPECT_GT(distorted, 1) << "the distortion is large enough to test the fit";
  auto const residual = dataset("case/calibration.h5", "/dots/pinhole_residual_px");
  double sum = 0;
  for (double const r : residual) sum += r * r;
  EXPECT_LT(std::sqrt(sum / static_cast<double>(residual.size())), 0.01);
}

std::string stereo_calibration() {
  std::string const camera = with(wide, "[geometry]\nz_a_mm = 300.0\n", "");
  std::string const one =
      camera.substr(camera.find("[camera]") + 9, camera.find("[lens]") - camera.find("[camera]") - 9);
  auto const tables = [&](std::string const& name, std::string const& x) {
    return "[[camera]]\nname = \"" + name + "\"\n" + one + "[camera.pose]\nposition_mm = [" + x +
           ", 0.0, 280.0]\n[camera.sensor]\nscheimpflug = \"auto\"\n";
  };
  return "experiment = \"calibration\"\n" + tables("left", "-110.0") + tables("right", "110.0") +
         camera.substr(camera.find("[lens]"));
}

TEST_F(Calibrations, RecoverAStereoPairWithScheimpflug) {
  write("setup.toml", stereo_calibration());
  render("case");
  auto const json = calibrate("case");
  ASSERT_EQ(json["cameras"].size(), 2u);
  for (std::string const name : {"left", "right"}) {
    expect_recovered(json["cameras"][name]);
    EXPECT_TRUE(fs::exists(in("case/" + name + "/calibration.h5")));
  }
  // the principal point is the intersection of the sensor with its normal through the lens, z_i tan(tilt) from the
  // middle
  EXPECT_GT(std::abs(json["cameras"]["left"]["pinhole"]["parameters"]["cx"]["value"].get<double>() - 319.5), 50);
}

// A thick inclined optical window is not described by a pinhole camera, but by the polynomial.
TEST_F(Calibrations, ThroughAWindowThePolynomialHolds) {
  write("setup.toml",
        std::string(wide) + "[[window]]\nposition_mm = [0, 0, 80]\nthickness_mm = 30\ntilt_deg = [15, 0]\n");
  render("case");
  auto const json = calibrate("case");
  EXPECT_FALSE(json["pinhole"]["parameters"]["fx"].contains("rendered"));
  EXPECT_LT(json["soloff"]["rms_px"].get<double>(), 0.1);
  EXPECT_EQ(json["dots"], 3 * 13 * 9);
}

TEST_F(Calibrations, FiguresShowTheResiduals) {
  write("setup.toml", wide);
  render("case");
  succeed({"calibrate", "case", "--quiet"});
  EXPECT_TRUE(fs::exists(in("case/calibration_residuals.png")));
  render("case");  // results derived from the old planes are deleted
  EXPECT_FALSE(fs::exists(in("case/calibration_residuals.png")));
  EXPECT_FALSE(fs::exists(in("case/calibration.h5")));
}

TEST_F(Calibrations, WhatCannotBeCalibratedIsRefused) {
  write("setup.toml", with(wide, "[-20.0, 0.0, 20.0]", "[0.0]"));
  render("one");
  expect_error({"calibrate", "one"}, 2, "undetermined at setup.toml", {"calibration.planes_mm"});
  write("setup.toml", with(wide, "extent_mm = [60.0, 45.0]", "extent_mm = [10.0, 10.0]"));
  render("few");
  expect_error({"calibrate", "few"}, 2, "undetermined at plane_000.tif", {"9 dots", "12"});
  write("setup.toml", small_setup);
  render("bos");
  expect_error({"calibrate", "bos"}, 2, "wrong_format at bos", {"experiment = \"calibration\""});
  expect_error({"calibrate", "nowhere"}, 2, "wrong_format at nowhere");
  write("setup.toml", wide);
  render("case");
  fs::copy_file(in("bos/reference.tif"), in("case/plane_001.tif"), fs::copy_options::overwrite_existing);
  expect_error({"calibrate", "case"}, 2, "wrong_shape at plane_001.tif", {"64 x 64 px", "640 x 480"});
  fs::remove(in("case/plane_001.tif"));
  expect_error({"calibrate", "case"}, 2, "missing_file at plane_001.tif");
}

TEST_F(Calibrations, ReportMissingDots) {
  write("setup.toml", with(wide, "bit_depth = 12", "bit_depth = 12\nexposure = 1.0"));
  render("dark");
  expect_error({"calibrate", "dark"}, 2, "undetermined at plane_000.tif", {"0 dots"});
}

TEST_F(Calibrations, OtherCommandsReportCalibrationCase) {
  write("setup.toml", wide);
  render("case");
  expect_error({"correlate", "case"}, 2, "wrong_format at case", {"gladstone calibrate case"});
  expect_error({"compare", "case"}, 2, "wrong_format at case");
}

// Images in any folder are calibrated like those of the case from which they were copied, with a setup that contains
// the position of the camera to a centimetre only: the grid itself determines its middle.
TEST_F(Calibrations, AcceptExternalImages) {
  write("setup.toml", wide);
  succeed({"render", "setup.toml", "-o", "case", "--quiet"});
  std::vector<std::string> pictures;
  for (std::string const index : {"0", "1", "2"}) {
    fs::copy_file(in("case/plane_00" + index + ".tif"), in("shot" + index + ".tif"));
    pictures.push_back("shot" + index + ".tif");
  }
  std::string roughly = wide;
  roughly.replace(roughly.find("z_a_mm = 300.0"), 14, "z_a_mm = 310.0");
  write("roughly.toml", roughly);
  auto const with = [&pictures](std::vector<std::string> arguments, std::size_t count) {
    arguments.emplace_back("--images");
    arguments.insert(arguments.end(), pictures.begin(), pictures.begin() + static_cast<std::ptrdiff_t>(count));
    return arguments;
  };
  auto const own = json_of(with({"calibrate", "roughly.toml", "-o", "camera", "--quiet", "--no-figures"}, 3));
  auto const cases = calibrate("case");
  EXPECT_EQ(names("camera"), std::vector<std::string>{"calibration.h5"});
  EXPECT_THAT(succeed(with({"calibrate", "roughly.toml", "-o", "camera", "--quiet", "--no-figures"}, 3)),
              testing::HasSubstr("no comparison with a rendered camera: your own images have no truth"));
  EXPECT_EQ(own["dots"], cases["dots"]);
  EXPECT_EQ(own["planes"][2]["z_mm"], 20.0);
  for (auto const& [name, parameter] : cases["pinhole"]["parameters"].items()) {
    // both fits have the same start and end; the light across the pupil is computed for a position 10 mm farther:
    // (R/z)^2 of 3 %
    auto const& here = own["pinhole"]["parameters"][name];
    EXPECT_NEAR(here["value"].get<double>(), parameter["value"].get<double>(),
                3 * parameter["standard_error"].get<double>())
        << name;
    EXPECT_FALSE(here.contains("rendered"));
  }
  expect_error(with({"calibrate", "roughly.toml", "-o", "other", "--quiet"}, 2), 2, "inconsistent at roughly.toml",
               {"3 planes", "2 images"});
  std::string two = roughly;
  std::string const one_camera = "[camera]";
  two.replace(two.find(one_camera), one_camera.size(), "[[camera]]\nname = \"left\"");
  write("two.toml", two + "\n[[camera]]\nname = \"right\"\n");
  expect_error(with({"calibrate", "two.toml", "-o", "other", "--quiet"}, 3), 2, "wrong_format at two.toml",
               {"2 cameras", "left, right"});
  std::reverse(pictures.begin(), pictures.end());
  expect_error(with({"calibrate", "roughly.toml", "-o", "other", "--quiet"}, 3), 2, "inconsistent at roughly.toml",
               {"calibration.planes_mm"});
}

/// Images of a rendered case, calibrated as if they were the user's own.
class CalibrationPictures : public Calibrations {
 protected:
  void SetUp() override {
    Calibrations::SetUp();
    write("setup.toml", wide);
    render("case");
  }
  static std::vector<std::string> arguments(std::vector<std::string> const& pictures) {
    std::vector<std::string> all{"calibrate", "setup.toml", "-o", "camera", "--quiet", "--no-figures", "--images"};
    for (std::string const& picture : pictures) all.push_back(picture);
    return all;
  }
  nlohmann::json calibrated(std::vector<std::string> const& pictures) const { return json_of(arguments(pictures)); }
  /// fx of the thin lens in focus on Z = 0: its image distance divided by the pixel pitch.
  static constexpr double fx = 24e-3 * 0.3 / (0.3 - 24e-3) / 10e-6;
  std::string const p0 = "case/plane_000.tif", p1 = "case/plane_001.tif", p2 = "case/plane_002.tif";
};

TEST_F(CalibrationPictures, ThatAreGivenTwiceOrInAnotherOrderAreRefusedByName) {
  expect_error(arguments({p1, p1, p1}), 2, "inconsistent at plane_001.tif", {"case/plane_001.tif"});
  expect_error(arguments({p0, p0, p2}), 2, "inconsistent at plane_000.tif",
               {"case/plane_000.tif", "Z = 0 mm", "-20 mm"});
  expect_error(arguments({p0, p2, p1}), 2, "inconsistent at setup.toml",
               {"case/plane_000.tif, case/plane_001.tif, case/plane_002.tif"});
  EXPECT_FALSE(fs::exists(in("camera/calibration.h5")));
}

// A second exposure of the same plane, with independent noise, does not count as another plane.
TEST_F(CalibrationPictures, OfOnePlaneTakenTwiceAreRefused) {
  Image<double> const picture = read_image(in(p0).string());
  Image<std::uint16_t> other(picture.columns(), picture.rows());
  for (std::size_t i = 0; i < picture.size(); ++i) {
    other.data()[i] = static_cast<std::uint16_t>(picture.data()[i] + static_cast<double>(i % 3));
  }
  write_tiff(in("again.tif").string(), other, {12, 10e-6, ""});
  expect_error(arguments({p0, "again.tif", p2}), 2, "inconsistent at again.tif", {"case/plane_000.tif"});
}

// Dirt that touches a dot shifts its centroid by pixels: such dots are counted and excluded, and the camera is
// unchanged.
TEST_F(CalibrationPictures, WithDirtLeaveItOut) {
  auto const places = dataset("case/truth.h5", "/dots/image_px");
  Image<double> const picture = read_image(in(p1).string());
  Image<std::uint16_t> dirty(picture.columns(), picture.rows());
  std::copy(picture.begin(), picture.end(), dirty.begin());
  std::size_t const dots = 117, spots = 3;
  for (std::size_t k = 0; k < spots; ++k) {
    std::size_t const dot = dots + 30 + 20 * k;  // on the second plane
    int const left = static_cast<int>(places[2 * dot]) + 5, top = static_cast<int>(places[2 * dot + 1]) - 2;
    for (int row = top; row < top + 5; ++row) {
      for (int column = left; column < left + 4; ++column) dirty(column, row) = 3000;
    }
  }
  write_tiff(in("dirty.tif").string(), dirty, {12, 10e-6, ""});
  auto const json = calibrated({p0, "dirty.tif", p2});
  auto const& plane = json["planes"][1];
  EXPECT_EQ(plane["not_dots"].get<std::size_t>() + plane["strangers"].size(), spots) << plane;
  EXPECT_EQ(json["dots"], 3 * dots - spots);
  auto const& parameter = json["pinhole"]["parameters"]["fx"];
  EXPECT_NEAR(parameter["value"].get<double>(), fx, 4 * parameter["standard_error"].get<double>());
  EXPECT_LT(json["pinhole"]["rms_px"].get<double>(), 0.01);
}

// A plate that moves by `share` times Z along X looks like a camera that moves in the opposite direction from plane to
// plane.
TEST_F(CalibrationPictures, OfAPlateThatDoesNotMoveAlongItsNormalGiveTheCameraAndTheDrift) {
  double const drift = 0.04;  // 2.3 degrees
  std::vector<std::string> pictures;
  for (double const z : {-20.0, 0.0, 20.0}) {
    double const across = drift * z, along = std::sqrt(1 - drift * drift) * z;
    std::string one = with(wide, "[-20.0, 0.0, 20.0]", "[" + std::to_string(along) + "]");
    one =
        with(one, "[geometry]\nz_a_mm = 300.0\n",
             "[camera.pose]\nposition_mm = [" + std::to_string(-across) + ", 0.0, 300.0]\nrotation_deg = [0, 0, 0]\n");
    write("one.toml", one);
    std::string const folder = "z" + std::to_string(pictures.size());
    succeed({"render", "one.toml", "-o", folder, "--quiet"});
    pictures.push_back(folder + "/plane_000.tif");
  }
  auto const json = calibrated(pictures);
  // the principal point is determined to 1 px here, so that the drift is determined to 1 / fx
  EXPECT_NEAR(json["drift"][0].get<double>(), drift, 5 / fx);
  EXPECT_NEAR(json["drift"][1].get<double>(), 0, 5 / fx);
  EXPECT_THAT(warnings_in(json), testing::Contains("inconsistent"));
  auto const& parameter = json["pinhole"]["parameters"]["fx"];
  EXPECT_NEAR(parameter["value"].get<double>(), fx, 1e-3 * fx);
}

// The plate of the first plane was shifted by one dot: its whole grid is visible, but at another position than stated.
TEST_F(CalibrationPictures, WithAMiddleDotThatIsOffByOneAreCorrected) {
  write("one.toml", with(with(wide, "[-20.0, 0.0, 20.0]", "[-20.0]"), "[geometry]\nz_a_mm = 300.0\n",
                         "[camera.pose]\nposition_mm = [-5.0, 0.0, 300.0]\nrotation_deg = [0, 0, 0]\n"));
  succeed({"render", "one.toml", "-o", "aside", "--quiet"});
  auto const json = calibrated({"aside/plane_000.tif", p1, p2});
  EXPECT_THAT(warnings_in(json), testing::Contains("assumed at plane_000.tif"));
  auto const& parameter = json["pinhole"]["parameters"]["fx"];
  EXPECT_NEAR(parameter["value"].get<double>(), fx, 4 * parameter["standard_error"].get<double>());
  EXPECT_LT(json["pinhole"]["rms_px"].get<double>(), 0.01);
}

}  // namespace
}  // namespace gladstone::end_to_end
