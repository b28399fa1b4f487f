#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "analysis/vectors/three_components.h"
#include "studies/case/case.h"
#include "studies/compare/stereo_cameras.h"
#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

/// Two cameras at 750 mm from a sheet, at an angle to either side of its normal: 16.28 px/mm.
std::string stereo_setup(double degrees, std::string const& velocity) {
  double const angle = degrees * std::numbers::pi / 180;
  auto const camera = [&](char const* name, double side) {
    return std::string("[[camera]]\nname = \"") + name + "\"\npixels = [128, 128]\npixel_pitch_um = 10.0\n" +
           "pose.position_mm = [" + std::to_string(side * 750 * std::sin(angle)) + ", 0.0, " +
           std::to_string(750 * std::cos(angle)) + "]\nsensor.scheimpflug = \"auto\"\n";
  };
  return "schema = 1\nexperiment = \"piv\"\n" + camera("left", -1) + camera("right", 1) + R"(
[lens]
focal_length_mm = 105.0
f_number = 22.0
[particles]
per_pixel = 0.05
volume_mm = [16.0, 12.0, 1.0]
scattering = "lambert"
[laser]
thickness_mm = 0.5
[flow]
velocity_m_s = )" +
         velocity +
         R"(
dt_us = 10.0
[correlate]
window_px = [32, 32]
overlap = 0.5
uncertainty = "correlation_statistics"
)";
}

class Stereo : public ProgramFixture {
 protected:
  void measure(double degrees, std::string const& velocity) const {
    write("setup.toml", stereo_setup(degrees, velocity));
    render("case");
    for (char const* camera : {"case/left", "case/right"}) succeed({"correlate", camera, "--quiet"});
  }
  nlohmann::json combine(std::vector<std::string> const& more = {}) const {
    std::vector<std::string> arguments{"stereo", "case/left", "case/right", "-o", "uvw.h5", "--quiet", "--no-figures"};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return json_of(arguments);
  }
  /// Expects the displacement (0.15, -0.12, 0.10) mm.
  static void expect_motion(nlohmann::json const& result, double degrees) {
    EXPECT_NEAR(result["view_angle_deg"].get<double>(), 2 * degrees, 1e-6);
    EXPECT_GT(result["determined"].get<int>(), 12) << result;
    double const expected_mm[] = {0.15, -0.12, 0.1};
    int axis = 0;
    for (char const* component : {"u", "v", "w"}) {
      auto const& error = result["error"][component];
      double const count = error["count"], rms = error["rms_px"], allowance = 0.02 + 3 * rms / std::sqrt(count / 4);
      EXPECT_LT(std::abs(error["bias_px"].get<double>()), allowance) << degrees << component << error;
      EXPECT_LT(rms, 0.1) << component;
      EXPECT_NEAR(result[component]["mean_mm"].get<double>(), expected_mm[axis++],
                  allowance * result["pixel_size_mm"].get<double>())
          << component;
      EXPECT_GT(result[component]["sigma_mm"].get<double>(), 0) << component;
    }
  }
  std::vector<double> dataset(std::string const& name) const { return Hdf5Reader(in("uvw.h5").string()).read(name); }
  /// Writes a calibration file with the exact camera of a case.
  void write_calibration(std::string const& name, std::string const& folder, double standard_error) const {
    std::string const setup = in(folder + "/setup.toml").string();
    auto const p = find_exact_camera(load_case_setup(setup, {}).setup, folder).camera.value;
    Hdf5Writer file(in(name).string(), {"gladstone calibration", 1, content(setup), 0, "cpu"});
    auto const put = [&](char const* dataset, std::vector<double> const& values) {
      file.write(dataset, std::span<double const>(values), {values.size()}, "1", "of a test", "value");
    };
    put("/pinhole/camera_matrix", {p[0], 0, p[2], 0, p[1], p[3], 0, 0, 1});
    put("/pinhole/distortion", {p[4], p[5], p[6], p[7]});
    put("/pinhole/rvec", {p[8], p[9], p[10]});
    put("/pinhole/tvec", {p[11], p[12], p[13]});
    std::vector<double> covariance(p.size() * p.size());
    for (std::size_t i = 8; i < 11; ++i) covariance[i * (p.size() + 1)] = standard_error * standard_error;
    put("/pinhole/covariance", covariance);
    file.close();
  }
};

// Uniform motion of 2 to 3 px along each axis at 30 and 45 degrees. Every component agrees with the motion of the
// particles to 0.02 px, beyond three standard errors of the mean (a quarter of the overlapping vectors is independent).
TEST_F(Stereo, MeasuresUniformMotionInThreeComponents) {
  for (double const degrees : {30.0, 45.0}) {
    measure(degrees, "[15.0, -12.0, 10.0]");
    expect_motion(combine(), degrees);
    expect_motion(combine({"--dewarp", "images"}), degrees);
  }
  for (double const value : dataset("/sigma_calibration_mm"))
    EXPECT_TRUE(std::isnan(value) || value == 0) << "exact cameras";
}

// Files with the same cameras as calibrations give the same displacements, and a larger uncertainty. The folder of a
// case with two cameras may be given instead of its two cases. --csv prints the same values as --json.
TEST_F(Stereo, ReadsTheFolderOfBothCameras) {
  measure(40, "[15.0, -12.0, 10.0]");
  auto of_folder = json_of({"stereo", "case", "-o", "uvw.h5", "--quiet", "--no-figures"});
  EXPECT_EQ(of_folder, combine());
  EXPECT_THAT(
      succeed({"stereo", "case", "-o", "uvw.h5", "--quiet", "--no-figures", "--csv"}),
      testing::HasSubstr(fmt::format("\nw.mean_mm,,mean,{:.17g},mm,\n", of_folder["w"]["mean_mm"].get<double>())));
  expect_error({"stereo", "case/left", "-o", "uvw.h5"}, 2, "wrong_format at left");
  expect_error({"stereo", "case/left/vectors.h5", "-o", "uvw.h5"}, 2, "wrong_format at vectors.h5");
  expect_error({"stereo", "none", "-o", "uvw.h5"}, 2, "wrong_format at none");
}

// Cameras that see different parts of the sheet, or a sheet far from the assumed one, have no vectors in common.
TEST_F(Stereo, RefusesCamerasThatDoNotOverlap) {
  write("setup.toml", with(with(stereo_setup(40, "[15.0, -12.0, 10.0]"), "sensor.scheimpflug = \"auto\"",
                                "pose.look_at_mm = [-8.0, 0.0, 0.0]\nsensor.scheimpflug = \"auto\""),
                           "volume_mm = [16.0, 12.0, 1.0]", "volume_mm = [30.0, 12.0, 1.0]"));
  std::string const both = read("setup.toml");
  auto const second = both.rfind("sensor.scheimpflug");
  write("setup.toml", both.substr(0, second) + "pose.look_at_mm = [8.0, 0.0, 0.0]\n" + both.substr(second));
  render("case");
  for (char const* camera : {"case/left", "case/right"}) succeed({"correlate", camera, "--quiet"});
  for (char const* dewarp : {"vectors", "images"})
    expect_error({"stereo", "case", "--dewarp", dewarp, "-o", "uvw.h5"}, 2,
                 std::string(dewarp) == "vectors" ? "undetermined at right" : "inconsistent at right",
                 {"case/left", "--sheet-z"});
  std::filesystem::remove(in("case/right/flow.tif"));
  expect_error({"stereo", "case", "--dewarp", "images", "-o", "uvw.h5"}, 2, "missing_file at flow.tif");
}

TEST_F(Stereo, ReadsVectorsAndCalibrations) {
  measure(40, "[15.0, -12.0, 10.0]");
  auto const exact = combine();
  auto const displacement = dataset("/displacement_mm"), sigma = dataset("/sigma_mm");
  write_calibration("a.h5", "case/left", 1e-3);
  write_calibration("b.h5", "case/right", 1e-3);
  auto const result = json_of({"stereo", "case/left/vectors.h5", "case/right/vectors.h5", "--calibration", "a.h5",
                               "b.h5", "-o", "uvw.h5", "--quiet", "--no-figures"});
  EXPECT_FALSE(result.contains("error")) << "no truth without cases";
  EXPECT_EQ(result["calibrations"], (std::vector<std::string>{"a.h5", "b.h5"}));
  auto const again = dataset("/displacement_mm"), larger = dataset("/sigma_mm"),
             part = dataset("/sigma_calibration_mm");
  ASSERT_EQ(again.size(), displacement.size());
  for (std::size_t i = 0; i < again.size(); ++i) {
    if (!std::isfinite(displacement[i])) continue;
    EXPECT_NEAR(again[i], displacement[i], 1e-9);
    EXPECT_GT(part[i], 0);
    EXPECT_NEAR(larger[i], std::hypot(sigma[i], part[i]), 1e-6 * larger[i]);
  }
  Hdf5Reader const file(in("uvw.h5").string());
  for (char const* attribute : {"vectors_a_sha256", "vectors_b_sha256", "calibration_a_sha256", "calibration_b_sha256"})
    EXPECT_NE(file.attribute(attribute), "") << attribute;
}

// A thin sheet 0.5 mm off the plane of the calibration and inclined by one degree: its normal is (0, -tan 1, 1), so
// that dZ/dY is tan 1. The correlation weights particles by the square of the light, with a standard deviation of
// 0.1 mm / sqrt(32) = 18 um along Z: the mean of 1000 particles is known to 0.6 um, and its slope over 8 mm to 0.00025.
// Limits: 5 times as much.
TEST_F(Stereo, FindsAMisalignedSheet) {
  std::string text = stereo_setup(40, "[5.0, -4.0, 1.0]");
  text = with(text, "thickness_mm = 0.5",
              "thickness_mm = 0.1\ncenter_mm = [0.0, 0.0, 0.5]\nnormal = [0.0, -0.0174551, 1.0]");
  text = with(text, "volume_mm = [16.0, 12.0, 1.0]", "volume_mm = [16.0, 12.0, 0.4]\ncenter_mm = [0.0, 0.0, 0.5]");
  text = with(text, "per_pixel = 0.05", "per_pixel = 0.1");
  write("setup.toml", text);
  render("case");
  for (char const* camera : {"case/left", "case/right"}) succeed({"correlate", camera, "--quiet"});
  auto const result = combine({"--align"});
  auto const& sheet = result["sheet"];
  EXPECT_GT(sheet["disparity_px"].get<double>(), 5) << sheet;
  EXPECT_LT(sheet["residual_px"].get<double>(), 0.05) << sheet;
  EXPECT_TRUE(sheet["used"].get<bool>());
  EXPECT_NEAR(sheet["z_mm"].get<double>(), 0.5, 0.003);
  EXPECT_NEAR(sheet["slope"][0].get<double>(), 0.0, 0.00125);
  EXPECT_NEAR(sheet["slope"][1].get<double>(), 0.01746, 0.00125);
  EXPECT_LT(sheet["z_sigma_mm"].get<double>(), 0.003) << sheet;
  EXPECT_LT(sheet["disparity_sigma_px"].get<double>(), 0.1) << sheet;
  expect_error({"stereo", "case/left", "case/right", "-o", "x.h5", "--align", "--images", "case/left/flow.tif"}, 2,
               "arguments at --images");
}

// The sheet is where it is assumed: a correction of less than three standard uncertainties is not used.
TEST_F(Stereo, KeepsAGivenSheetThatTheImagesConfirm) {
  measure(40, "[5.0, -4.0, 1.0]");
  auto const result = combine({"--align"});
  EXPECT_FALSE(result["sheet"]["used"].get<bool>()) << result["sheet"];
  Hdf5Reader const file(in("uvw.h5").string());
  EXPECT_EQ(std::stod(file.attribute("sheet_z_mm")), 0.0);
  EXPECT_EQ(file.attribute("residual_disparity_px"), "");
}

// Both cameras mask their columns from 100 on, X = (100 - 63.5) 0.0614 mm / cos 40 = 2.9 mm on the sheet: the vectors
// end there whether they or the images are dewarped, within two distances of vectors, since windows count of which half
// is visible. The corners in pixels of the dewarped images would move this border by 1 mm. An image is the same mask.
TEST_F(Stereo, MasksApplyToTheRecordedImages) {
  std::string const text = with(stereo_setup(40, "[5.0, -4.0, 1.0]"), "window_px = [32, 32]\noverlap = 0.5",
                                "window_px = [32, 16]\noverlap = 0.75");
  Image<std::uint16_t> mask(128, 128, 1);
  for (int row = 0; row < 128; ++row)
    for (int column = 100; column < 128; ++column) mask(column, row) = 0;
  write_tiff(in("mask.tif").string(), mask, {});
  auto const find_border = [&](std::string const& kind, std::vector<std::string> const& more) {
    write("setup.toml", text + "[[correlate.mask]]\n" + kind);
    render("case");
    for (char const* camera : {"case/left", "case/right"}) succeed({"correlate", camera, "--quiet"});
    combine(more);
    std::vector<double> const x = dataset("/x_mm"), displacement = dataset("/displacement_mm");
    double largest = -100;
    for (std::size_t i = 0; i < displacement.size() / 3; ++i)
      if (std::isfinite(displacement[3 * i])) largest = std::max(largest, x[i % x.size()]);
    return largest;
  };
  std::string const polygon = "kind = \"polygon\"\nx_px = [99.5, 130, 130, 99.5]\ny_px = [-1, -1, 130, 130]\n";
  double const spacing_mm = 4 * 0.07, vectors = find_border(polygon, {}),
               images = find_border(polygon, {"--dewarp", "images"});
  EXPECT_NEAR(vectors, 2.9, 2 * spacing_mm);
  EXPECT_NEAR(images, vectors, 2 * spacing_mm);
  EXPECT_EQ(find_border("kind = \"image\"\nfile = \"mask.tif\"\n", {"--dewarp", "images"}), images);
  EXPECT_NE(Hdf5Reader(in("uvw.h5").string()).attribute("preparation_b_1_sha256"), "");
}

// A plane assumed 0.5 mm off the sheet: the disparity is 0.5 mm times 2 tan 40 over the size of a pixel, 0.0614 mm /
// sqrt(cos 40): 12 px.
TEST_F(Stereo, WarnsOfADisplacedSheet) {
  measure(40, "[15.0, -12.0, 10.0]");
  auto const placed = combine();
  EXPECT_THAT(warnings_in(placed), testing::Not(testing::Contains("inconsistent")));
  auto const displaced = combine({"--sheet-z", "0.5"});
  EXPECT_THAT(warnings_in(displaced), testing::Contains("inconsistent"));
  EXPECT_NEAR(displaced["given_sheet"]["disparity_px"].get<double>(), 12.0, 1.0);
}

TEST_F(Stereo, DewarpedImagesHaveAnUncertaintyWithoutSetting) {
  std::string const text = with(stereo_setup(30, "[5.0, -4.0, 1.0]"), "\"correlation_statistics\"", "\"none\"");
  write("setup.toml", text);
  render("case");
  for (char const* camera : {"case/left", "case/right"}) succeed({"correlate", camera, "--quiet"});
  auto const vectors = combine();
  EXPECT_TRUE(vectors["w"]["sigma_mm"].is_null());
  EXPECT_THAT(warnings_in(vectors), testing::Contains("incomplete"));
  auto const images = combine({"--dewarp", "images"});
  EXPECT_GT(images["w"]["sigma_mm"].get<double>(), 0);
  EXPECT_THAT(warnings_in(images), testing::Not(testing::Contains("incomplete")));
}

// A pane of 3 mm moves the images by some 20 px. Cameras that were calibrated through it measure as without it: within
// 0.02 px, beyond three standard errors of the mean.
TEST_F(Stereo, CalibrationsThroughAWindowAccountForIt) {
  std::string const window = "[[window]]\nposition_mm = [0.0, 0.0, 100.0]\nthickness_mm = 3.0\n";
  std::string const text = stereo_setup(45, "[15.0, -12.0, 10.0]") + window;
  write("setup.toml", text);
  render("case", {"--set", "render.rays_per_dot=8"});
  for (char const* camera : {"case/left", "case/right"}) succeed({"correlate", camera, "--quiet"});
  std::string const cameras = text.substr(0, text.find("[particles]"));
  write("plates.toml", with(cameras, "\"piv\"", "\"calibration\"") + window +
                           "[calibration]\nplanes_mm = [-2.0, 0.0, 2.0]\nspacing_mm = 0.8\ndot_diameter_mm = 0.4\n"
                           "extent_mm = [16.0, 12.0]\n[render]\nrays_per_dot = 128\n");
  succeed({"render", "plates.toml", "-o", "plates", "--quiet"});
  for (char const* camera : {"plates/left", "plates/right"}) succeed({"calibrate", camera, "--no-figures", "--quiet"});
  auto const result = combine({"--calibration", "plates/left/calibration.h5", "plates/right/calibration.h5"});
  EXPECT_GT(result["determined"].get<int>(), 12) << result;
  for (char const* component : {"u", "v", "w"}) {
    auto const& error = result["error"][component];
    double const count = error["count"], rms = error["rms_px"];
    EXPECT_LT(std::abs(error["bias_px"].get<double>()), 0.02 + 3 * rms / std::sqrt(count / 4)) << component << error;
  }
}

TEST_F(Stereo, ThreeComponentsAreConvertedAndScored) {
  measure(30, "[5.0, -4.0, 1.0]");
  auto const result = combine();
  auto const score = json_of({"compare", "uvw.h5", "--quiet"});
  // The file holds millimetres: in pixels, displacements below 10 px differ by two roundings at most, 4e-15 px.
  for (char const* component : {"u", "v", "w"}) {
    for (auto const& [name, value] : result["error"][component].items()) {
      EXPECT_NEAR(score["error"][component][name].get<double>(), value.get<double>(), 1e-14) << component << name;
    }
  }
  EXPECT_EQ(score["valid"], result["determined"]);
  EXPECT_EQ(score["rejected"], result["rejected"]);
  EXPECT_EQ(score["gross"], 0) << "errors of uniform motion are far below 1 px";
  for (std::string const& ending : three_component_extensions()) {
    auto const json = json_of({"convert", "uvw.h5", "-o", "uvw" + ending, "--quiet"});
    EXPECT_EQ(json["columns"], result["columns"]) << ending;
    EXPECT_EQ(json["valid"], result["determined"]) << ending;
  }
  std::vector<double> displacement = dataset("/displacement_mm");
  std::vector<double> const w = Hdf5Reader(in("uvw.nc").string()).read("/w");
  for (std::size_t i = 0; i < w.size(); ++i) EXPECT_TRUE(w[i] == displacement[3 * i + 2] || std::isnan(w[i]));
  expect_error({"convert", "uvw.h5", "-o", "other.h5"}, 2, "output at other.h5");
  expect_error({"compare", "uvw.h5", "--vectors", "v.csv"}, 2, "arguments at --vectors");
}

TEST_F(Stereo, RefusesWhatItCannotCombine) {
  measure(40, "[15.0, -12.0, 10.0]");
  write_calibration("a.h5", "case/left", 1e-3);
  write_calibration("b.h5", "case/right", 1e-3);
  auto const refused = [&](std::vector<std::string> arguments, std::string const& error,
                           std::vector<std::string> const& values = {}) {
    arguments.insert(arguments.begin(), "stereo");
    expect_error(arguments, 2, error, values);
  };
  refused({"case/left", "case/right", "-o", "uvw.txt"}, "output at uvw.txt", {".h5"});
  refused({"case/left", "case/right", "-o", "case/left/vectors.h5"}, "overwrites_input at vectors.h5");
  refused({"case/left", "case/left", "-o", "uvw.h5"}, "undetermined at left");
  refused({"case/left", "case/right", "--calibration", "b.h5", "a.h5", "-o", "uvw.h5"}, "inconsistent at b.h5",
          {"case/left"});
  refused({"case/left/vectors.h5", "case/right/vectors.h5", "-o", "uvw.h5"}, "wrong_format at vectors.h5",
          {"--calibration"});
  refused({"case/left", "case/right", "--calibration", "case/left/truth.h5", "case/right/truth.h5", "-o", "uvw.h5"},
          "wrong_format at truth.h5");
  refused({"case/left/vectors.h5", "case/right/vectors.h5", "--calibration", "a.h5", "b.h5", "--dewarp", "images", "-o",
           "uvw.h5"},
          "wrong_format at vectors.h5", {"--dewarp"});
  refused({"case/left", "none", "-o", "uvw.h5"}, "missing_file at none");
  refused({"case/left", "case/right", "--spacing", "-1", "-o", "uvw.h5"}, "arguments at --spacing");
  refused({"case/left", "case/right", "--sheet-z", "nan", "-o", "uvw.h5"}, "invalid_value at --sheet-z");
  refused({"case/left", "case/right", "--residual-limit", "-1", "-o", "uvw.h5"}, "arguments at --residual-limit");
  write("behind.toml", stereo_setup(40, "[15.0, -12.0, 10.0]") + "[[window]]\nposition_mm = [0.0, 0.0, 100.0]\n");
  succeed({"render", "behind.toml", "-o", "behind", "--set", "render.rays_per_dot=4", "--quiet"});
  succeed({"correlate", "behind/left", "--quiet"});
  refused({"behind/left", "behind/right", "-o", "uvw.h5"}, "unsupported at left", {"--calibration"});
  refused({"behind/left", "behind/right", "--calibration", "a.h5", "b.h5", "-o", "uvw.h5"}, "inconsistent at a.h5");
  render("other", {"--set", "particles.seed=2"});
  succeed({"correlate", "other/right", "--quiet"});
  refused({"case/left", "other/right", "-o", "uvw.h5"}, "inconsistent at right");
  succeed({"init", "bos", "-o", "bos.toml"});
  succeed({"render", "bos.toml", "-o", "bos", "--set", "camera.pixels=[128, 128]", "--set", "render.rays_per_dot=4",
           "--set", "render.method=rays", "--quiet"});
  succeed({"correlate", "bos", "--quiet"});
  refused({"case/left", "bos", "-o", "uvw.h5"}, "wrong_format at bos", {"PIV"});
}

}  // namespace
}  // namespace gladstone::end_to_end
