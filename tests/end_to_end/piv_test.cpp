#include <cmath>

#include "render/base/vec.h"
#include "studies/compare/comparison_results.h"
#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

namespace fs = std::filesystem;

/// White spheres in a sheet with a displacement of 2.3 px: at M = 105 / 645 and 10 um that is 141.2857 um in 10 us.
constexpr char const* piv_setup = R"(schema = 1
experiment = "piv"

[camera]
pixels = [128, 128]
pixel_pitch_um = 10.0

[lens]
focal_length_mm = 105.0
f_number = 22.0

[geometry]
z_a_mm = 750.0

[particles]
per_pixel = 0.05
volume_mm = [12.0, 12.0, 1.5]
scattering = "lambert"

[laser]
thickness_mm = 1.0

[flow]
velocity_m_s = [14.12857, 0.0, 0.0]
dt_us = 10.0

[correlate]
window_px = [32, 32]
)";

class Piv : public ProgramFixture {
 protected:
  void SetUp() override {
    ProgramFixture::SetUp();
    write("setup.toml", piv_setup);
  }
  std::vector<double> dataset(std::string const& file, std::string const& name) const {
    return Hdf5Reader(in(file).string()).read(name);
  }
  /// Renders, correlates and compares; returns errors.json.
  nlohmann::json compute_error_measures(std::string const& setup) const {
    write("setup.toml", setup);
    render("case");
    succeed({"correlate", "case", "--quiet"});
    return json_of({"compare", "case", "--quiet", "--no-figures"});
  }
};

double sum_of_levels(Image<double> const& image) {
  double sum = 0;
  for (double const level : image) sum += level;
  return sum;
}

TEST_F(Piv, RecoversAShiftOf2Point3Pixels) {
  auto const errors = compute_error_measures(piv_setup);
  // noise-free, with only 13 particles per window: the error of the correlator is below 0.02 px
  EXPECT_NEAR(errors["ray_truth"]["bias_u_px"].get<double>(), 0, 0.02);
  EXPECT_LT(errors["ray_truth"]["rms_px"].get<double>(), 0.02);
  EXPECT_GT(errors["ray_truth"]["valid_fraction"].get<double>(), 0.9);
  // the flow is evaluated in the middle of the sheet, and there is no refraction
  EXPECT_NEAR(errors["budget"]["terms"]["projection"]["rms_px"].get<double>(), 0, 1e-5);
  EXPECT_EQ(errors["budget"]["terms"]["refraction"]["rms_px"].get<double>(), 0);
  EXPECT_LT(errors["budget"]["closure_px"].get<double>(), 1e-9);
  EXPECT_TRUE(errors["eq9"].is_null());
  auto const truth = dataset("case/truth.h5", "/particles/displacement_px");
  auto const place = dataset("case/truth.h5", "/particles/position_m");
  for (std::size_t i = 0; i < truth.size() / 2; ++i) {
    if (std::isnan(truth[2 * i])) continue;
    double const expected = 2.3 * 750e-3 / (750e-3 - place[3 * i + 2]);  // closer to the lens it is larger
    EXPECT_NEAR(truth[2 * i], expected, 1e-3);
    EXPECT_NEAR(truth[2 * i + 1], 0, 1e-3);
  }
}

// A vortex of up to 3 px, with its axis in the middle of the view. Central displacement: particles that are at a vector
// at mid-time have moved by the flow there times dt, except for the curvature of their paths, (angle of rotation)^2 /
// 24; the angle is at most 0.13. The displacement of particles that start there would differ by half of that angle, 7
// %.
TEST_F(Piv, ComparesAVortexWithItsFlow) {
  std::string const vortex = with(piv_setup, "velocity_m_s = [14.12857, 0.0, 0.0]",
                                  "kind = \"lamb_oseen\"\ncirculation_m2_s = 0.32\ncore_radius_mm = 2.0");
  auto const errors = compute_error_measures(vortex);
  auto const& terms = errors["budget"]["terms"];
  EXPECT_LT(terms["projection"]["rms_px"].get<double>(), 3 * 0.13 * 0.13 / 24);
  EXPECT_LT(errors["ambient_truth"]["rms_px"].get<double>(), 0.15);
  EXPECT_EQ(errors["ambient_truth"], errors["ray_truth"]);
  double const at_mid = terms["projection"]["rms_px"].get<double>();
  auto const reference = json_of({"compare", "case", "--quiet", "--no-figures", "--truth-at", "reference"});
  EXPECT_GT(reference["budget"]["terms"]["projection"]["rms_px"].get<double>(), 10 * at_mid);
}

// The electrons of the whole image are photons times quantum efficiency; a level is full_well_e over full scale. Levels
// are integers: the loss by rounding below half a level is small compared with 2000 electrons.
TEST_F(Piv, CountsElectrons) {
  std::string const absolute =
      with(with(piv_setup, "pixel_pitch_um = 10.0\n",
                "pixel_pitch_um = 10.0\nexposure = \"absolute\"\n[camera.noise]\nfull_well_e = 65535\nread_noise_e = "
                "0\nshot_noise = false\nquantum_efficiency = 0.4\n"),
           "per_pixel = 0.05", "number = 200");
  write("setup.toml", with(absolute, "[12.0, 12.0, 1.5]", "[6.0, 6.0, 0.5]"));
  auto const summary = json_of({"render", "setup.toml", "-o", "case", "--quiet"});
  EXPECT_DOUBLE_EQ(summary["particles"]["electrons_per_photon"].get<double>(), 0.4);
  auto const flux = dataset("case/truth.h5", "/particles/flux");
  double photons = 0;
  for (std::size_t i = 0; i < flux.size(); i += 2) photons += flux[i];
  double const electrons = sum_of_levels(read_image(in("case/reference.tif").string()));
  EXPECT_NEAR(electrons, 0.4 * photons, 0.01 * electrons);
  EXPECT_GT(electrons, 1e5);
}

TEST_F(Piv, IsTheSameAgainFromItsResolvedSetup) {
  render("case", {"--threads", "1"});
  render("again", {"--threads", "2"}, "case/setup.toml");
  auto const summary = nlohmann::json::parse(read("case/summary.json")),
             again = nlohmann::json::parse(read("again/summary.json"));
  EXPECT_EQ(summary["reference_sha256"], again["reference_sha256"]);
  EXPECT_EQ(summary["flow_sha256"], again["flow_sha256"]);
  EXPECT_EQ(dataset("case/truth.h5", "/particles/flux"), dataset("again/truth.h5", "/particles/flux"));
  EXPECT_LE(summary["rays_per_dot"].get<int>(), 256);  // "auto", in focus
}

// Two cameras 20 degrees to either side see the same particles.
TEST_F(Piv, ShowsTheSameParticlesToTwoCameras) {
  std::string stereo = with(piv_setup, "[camera]\npixels = [128, 128]\npixel_pitch_um = 10.0\n", R"([[camera]]
name = "left"
pixels = [128, 128]
[camera.pose]
position_mm = [-256.5, 0.0, 704.8]
[camera.sensor]
scheimpflug = "auto"
[[camera]]
name = "right"
pixels = [128, 128]
[camera.pose]
position_mm = [256.5, 0.0, 704.8]
[camera.sensor]
scheimpflug = "auto"
)");
  write("setup.toml", with(stereo, "[geometry]\nz_a_mm = 750.0\n", ""));
  render("case");
  auto const left = dataset("case/left/truth.h5", "/particles/position_m");
  EXPECT_EQ(left, dataset("case/right/truth.h5", "/particles/position_m"));
  EXPECT_GT(left.size(), 6u * 500);
  // both cameras see motion along X times the cosine of the angle, and motion along Z with opposite signs
  write("setup.toml",
        with(with(stereo, "[geometry]\nz_a_mm = 750.0\n", ""), "[14.12857, 0.0, 0.0]", "[0.0, 0.0, 10.0]"));
  render("deep");
  auto const mean = [&](std::string const& file) {
    auto const moved = dataset(file, "/particles/displacement_px");
    double sum = 0, count = 0;
    for (std::size_t i = 0; i < moved.size(); i += 2) {
      if (std::isnan(moved[i])) continue;
      sum += moved[i];
      ++count;
    }
    return sum / count;
  };
  // 0.1 mm towards the cameras; to the right for the left one is (cos 20, 0, sin 20 degrees): 0.1 * 0.342 * 16.28 px/mm
  EXPECT_NEAR(mean("deep/left/truth.h5"), 0.557, 0.02);
  EXPECT_NEAR(mean("deep/right/truth.h5"), -0.557, 0.02);
}

// A study over the time between the pulses: the truth is proportional to it.
TEST_F(Piv, AStudyVariesTheTimeBetweenPulses) {
  write("study.toml", "base = \"setup.toml\"\n[axes]\n\"flow.dt_us\" = [5.0, 10.0]\n");
  succeed({"sweep", "plan", "study.toml", "-o", "run", "--quiet", "--device", "cpu"});
  succeed({"sweep", "run", "run", "--quiet"});
  succeed({"sweep", "collect", "run", "--quiet"});
  std::string const table = read("run/study.csv");
  EXPECT_THAT(table, testing::HasSubstr("flow.dt_us"));
  EXPECT_THAT(table, testing::HasSubstr("budget.terms.projection.rms_px"));
  EXPECT_EQ(std::count(table.begin(), table.end(), '\n'), 3);
}

// A velocity from a file, u = 14.12857 m/s (1 + y / 60 mm), which splines reproduce: a displacement of 2.3 px (1 + y /
// 60 mm).
TEST_F(Piv, MovesParticlesByTheVelocityOfAFile) {
  constexpr std::size_t across = 15, deep = 3;
  std::vector<double> values;
  for (std::size_t node = 0; node < across * across * deep; ++node) {
    double const y = static_cast<double>(node / across % across) - 7;
    values.insert(values.end(), {14.12857 * (1 + y / 60), 0.0, 0.0});
  }
  Hdf5Writer file(in("velocity.h5").string(), {"test", 1, "", 0, "cpu"});
  file.write("Velocity_0001", std::span<double const>(values), {deep, across, across, 3}, "m/s", "velocity",
             "z, y, x, component");
  file.close();
  std::string const by_file = with(piv_setup, "velocity_m_s = [14.12857, 0.0, 0.0]",
                                   "kind = \"file\"\nfile = \"velocity.h5\"\nspacing_mm = [1, 1, 1]");
  auto const errors = compute_error_measures(by_file);
  EXPECT_LT(errors["ray_truth"]["rms_px"].get<double>(), 0.02);
  EXPECT_LT(errors["budget"]["terms"]["projection"]["rms_px"].get<double>(), 1e-4);
  auto const truth = dataset("case/truth.h5", "/particles/displacement_px");
  auto const place = dataset("case/truth.h5", "/particles/position_m");
  for (std::size_t i = 0; i < truth.size() / 2; ++i) {
    if (std::isnan(truth[2 * i])) continue;
    double const expected = 2.3 * (1 + place[3 * i + 1] / 60e-3) * 750e-3 / (750e-3 - place[3 * i + 2]);
    EXPECT_NEAR(truth[2 * i], expected, 1e-3);
  }
  auto const summary = nlohmann::json::parse(read("case/summary.json"));
  EXPECT_THAT(warnings_in(summary), testing::Not(testing::Contains("assumed at flow.file")));
  // the source file of a case is identified by its content
  EXPECT_THAT(Hdf5Reader(in("case/truth.h5").string()).attribute("inputs_sha256"), testing::HasSubstr("velocity.h5"));
  std::string const short_of_it = with(by_file, "spacing_mm = [1, 1, 1]", "spacing_mm = [0.8, 1, 1]");
  expect_setup_error(short_of_it, "invalid_value at setup.toml:" + place_of(short_of_it, "file = \"velocity.h5\""));
}

// Gas and particles through the front of a normal shock of Mach 1.5 in the middle of the view: behind it their
// displacement is u_2 / u_1 = 1 / 1.862 of that in front of it (NACA 1135: 2.4 M^2 / (0.4 M^2 + 2)). u_1 = 1.5 * 343.2
// m/s. Particles that cross the front are excluded: those within 0.3 mm of it.
TEST_F(Piv, MovesParticlesThroughAShock) {
  std::string const shock = with(
      with(piv_setup, "velocity_m_s = [14.12857, 0.0, 0.0]\ndt_us = 10.0", "kind = \"normal_shock\"\ndt_us = 0.25"),
      "[particles]",
      "[render]\nrays_per_dot = 64\n[medium]\nambient_density_kg_m3 = 1.0\n[medium.field]\nkind = "
      "\"normal_shock\"\nmach = "
      "1.5\nupstream_density_kg_m3 = 1.0\nshock_thickness_mm = 0.3\n[particles]");
  auto const errors = compute_error_measures(shock);
  EXPECT_LT(errors["budget"]["closure_px"].get<double>(), 1e-9);
  EXPECT_GT(errors["budget"]["terms"]["refraction"]["rms_px"].get<double>(), 0);
  auto const moved = dataset("case/truth.h5", "/particles/displacement_ambient_px");
  auto const place = dataset("case/truth.h5", "/particles/position_m");
  std::size_t const count = moved.size() / 2;
  double const px_per_m = 105.0 / 645 / 10e-6, before = 1.5 * std::sqrt(1.4 * 287.05287 * 293.15) * 0.25e-6;
  double upstream = 0, downstream = 0;
  for (std::size_t i = 0; i < count; ++i) {
    double const x = place[3 * i], z = place[3 * i + 2];
    if (std::isnan(moved[2 * i]) || std::abs(x) < 0.3e-3) continue;
    double const expected = before * px_per_m * (x < 0 ? 1 : 1 / 1.862068966) * 0.75 / (0.75 - z);
    EXPECT_NEAR(moved[2 * i], expected, 2e-3) << x;
    (x < 0 ? upstream : downstream) += 1;
  }
  // at least a hundred particles in each half; the half behind the front has 1.86 times as many
  EXPECT_NEAR(downstream / upstream, 1.86, 4 * 1.86 * std::sqrt(1 / upstream + 1 / downstream));
}

// Position error through a shock front at an angle tau to the line of sight, for a particle at a distance s behind it
// along that line: |xi| = dn cot(tau) s, and since s changes with x, |d xi / d x| = dn cot(tau)^2 (Elsinga, van
// Oudheusden & Scarano 2005). Here with the line of sight of every particle: a front with normal n deflects a ray of
// direction d by dn (n / (n . d) - d), so that a particle appears displaced by s times that. dn is K times 0.862 kg/m^3
// for Mach 1.5. The front has a thickness and the lens a stop: 1 % for both.
TEST_F(Piv, SeesParticlesBehindAShockWhereElsingaSaysTheyAre) {
  for (double const tau_deg : {30.0, 50.0}) {
    std::string const front =
        with(with(with(with(piv_setup, "[12.0, 12.0, 1.5]", "[12.0, 12.0, 20.0]"), "thickness_mm = 1.0",
                       "thickness_mm = 20.0\nprofile = \"top_hat\""),
                  "per_pixel = 0.05", "per_pixel = 0.01"),
             "[particles]",
             "[medium]\nthickness_mm = 60.0\nambient_density_kg_m3 = 1.862068966\n[medium.field]\nkind = "
             "\"normal_shock\"\nmach = 1.5\nupstream_density_kg_m3 = 1.0\nshock_thickness_mm = 0.2\ntilt_deg = " +
                 std::to_string(tau_deg) + "\n[particles]");
    write("setup.toml", front);
    std::string const name = "case" + std::to_string(static_cast<int>(tau_deg));
    render(name);
    auto const place = dataset(name + "/truth.h5", "/particles/position_m");
    auto const seen = dataset(name + "/truth.h5", "/particles/reference_px");
    auto const straight = dataset(name + "/truth.h5", "/particles/reference_ambient_px");
    auto const moved = dataset(name + "/truth.h5", "/particles/displacement_px");
    auto const moved_straight = dataset(name + "/truth.h5", "/particles/displacement_ambient_px");
    double const tau = tau_deg * std::acos(-1.0) / 180, jump = 2.26e-4 * 0.862068966;
    Vec3d const normal{std::cos(tau), 0, std::sin(tau)}, lens{0, 0, 0.75};
    auto const way_behind = [&](Vec3d at) { return -dot(normal, at) / dot(normal, normalized(lens - at)); };
    auto const xi = [&](Vec3d at) {
      Vec3d const sight = normalized(lens - at);
      return -way_behind(at) * jump * (normal.x / dot(normal, sight) - sight.x);
    };
    int behind = 0, before = 0;
    for (std::size_t i = 0; i < seen.size() / 2; ++i) {
      if (std::isnan(moved[2 * i])) continue;
      Vec3d const at{place[3 * i], place[3 * i + 1], place[3 * i + 2]}, later = at + Vec3d{141.2857e-6, 0, 0};
      double const px_per_m = 105.0 / 645 / 10e-6 * 0.75 / (0.75 - at.z);
      double const error_px = seen[2 * i] - straight[2 * i], change_px = moved[2 * i] - moved_straight[2 * i];
      if (std::abs(dot(normal, at)) < 0.8e-3) continue;  // in the front, or at the second pulse
      if (way_behind(at) < 0) {
        EXPECT_NEAR(error_px, 0, 1e-4);
        EXPECT_NEAR(change_px, 0, 1e-5);
        ++before;
        continue;
      }
      double const xi_px = xi(at) * px_per_m, xi_change_px = (xi(later) - xi(at)) * px_per_m;
      EXPECT_NEAR(error_px, xi_px, 0.01 * std::abs(xi_px) + 1e-4) << tau_deg << " degrees, " << way_behind(at);
      EXPECT_NEAR(change_px, xi_change_px, 0.01 * xi_change_px) << tau_deg << " degrees, " << way_behind(at);
      // near the axis, where all lines of sight are parallel
      double const cot = normal.x / normal.z, of_elsinga = jump * cot * cot * 141.2857e-6 * px_per_m;
      EXPECT_NEAR(xi_change_px, of_elsinga, 0.1 * of_elsinga);
      ++behind;
    }
    EXPECT_GT(behind, 100);
    EXPECT_GT(before, 100);
  }
}

// The second pulse sees another medium: particles at rest appear displaced by the effect of a gradient of 100 kg/m^4
// over 40 mm, g l^2 / 2 for a particle at a distance l = 20 mm from the face.
TEST_F(Piv, SeesAMediumThatChanges) {
  std::string const changing =
      with(with(piv_setup, "velocity_m_s = [14.12857, 0.0, 0.0]", "velocity_m_s = [0, 0, 0]"), "[particles]",
           "[render]\nrays_per_dot = 64\n[medium]\nthickness_mm = 40.0\n[medium.second_field]\nkind = "
           "\"uniform_gradient\"\ngradient_kg_m4 = [100.0, 0.0, 0.0]\n[particles]");
  auto const errors = compute_error_measures(changing);
  auto const moved = dataset("case/truth.h5", "/particles/displacement_px");
  auto const place = dataset("case/truth.h5", "/particles/position_m");
  for (std::size_t i = 0; i < moved.size() / 2; ++i) {
    if (std::isnan(moved[2 * i])) continue;
    double const way = 20e-3 - place[3 * i + 2], px_per_m = 105.0 / 645 / 10e-6 * 0.75 / (0.75 - place[3 * i + 2]);
    EXPECT_NEAR(moved[2 * i], -2.26e-4 * 100 * way * way / 2 * px_per_m, 2e-3);
  }
  EXPECT_NEAR(errors["budget"]["terms"]["refraction"]["bias_u_px"].get<double>(), -2.26e-4 * 100 * 4e-4 / 2 * 16279,
              2e-3);
  EXPECT_EQ(errors["budget"]["terms"]["projection"]["rms_px"].get<double>(), 0);
}

// Ideal images, without rays: 2.3 px again, and the method is recorded.
TEST_F(Piv, DrawsIdealImages) {
  std::string const ideal = with(piv_setup, "scattering = \"lambert\"", "scattering = \"gaussian\"");
  auto const errors = compute_error_measures(ideal);
  EXPECT_LT(errors["ray_truth"]["rms_px"].get<double>(), 0.02);
  auto const summary = nlohmann::json::parse(read("case/summary.json"));
  EXPECT_EQ(summary["method"], "formula");
  EXPECT_EQ(summary["rays"]["traced"], 0);
  EXPECT_GT(summary["particles"]["largest_blur_px"].get<double>(), 0);
  EXPECT_EQ(Hdf5Reader(in("case/truth.h5").string()).attribute("method"), "formula");
  render("again", {}, "case/setup.toml");
  EXPECT_EQ(nlohmann::json::parse(read("again/summary.json"))["flow_sha256"], summary["flow_sha256"]);
  // other scattering models may use this method, too; "gaussian" has no rays
  std::string const lambert = std::string(piv_setup) + "[render]\nmethod = \"formula\"\n";
  write("lambert.toml", lambert);
  render("lambert", {}, "lambert.toml");
  std::string const by_rays = ideal + "[render]\nmethod = \"rays\"\n";
  expect_setup_error(by_rays, "invalid_value at setup.toml:" + place_of(by_rays, "method = \"rays\""));
  std::string const tilted =
      with(ideal, "pixel_pitch_um = 10.0\n", "pixel_pitch_um = 10.0\nsensor.tilt_deg = [5, 0]\n");
  expect_setup_error(tilted, "invalid_value at setup.toml:" + place_of(tilted, "scattering = \"gaussian\""));
  expect_setup_error(with(lambert, "f_number = 22.0", "f_number = 22.0\npsf = \"airy\""),
                     "invalid_value at setup.toml:31:1");
}

// Background, glare, fixed-pattern noise and hot pixels are in the images but not in the truth; their effect on the
// vectors counts as noise.
TEST_F(Piv, PicturesHaveABackground) {
  std::string const ideal = with(piv_setup, "scattering = \"lambert\"", "scattering = \"gaussian\"");
  auto const clean = compute_error_measures(ideal);
  std::string const spoilt = with(
      ideal, "pixel_pitch_um = 10.0\n",
      "pixel_pitch_um = 10.0\nbit_depth = 12\n[camera.background]\nlevel_e = 500\ngradient_e = [300, 0]\nglare_file = "
      "\"case/reference.tif\"\nglare_e = 400\n[camera.noise]\nprnu_percent = 1.0\ndsnu_e = 20\nhot_pixel_share = "
      "0.001\n");
  write("spoilt.toml", spoilt);
  render("spoilt", {}, "spoilt.toml");
  succeed({"correlate", "spoilt", "--quiet"});
  auto const errors = json_of({"compare", "spoilt", "--quiet", "--no-figures"});
  // the estimator term uses images without a background; their levels differ by the exposure, and float correlation
  // rounds them to 6e-8 of a few px
  for (char const* part : {"bias_u_px", "bias_v_px", "random_u_px", "random_v_px"}) {
    EXPECT_NEAR(errors["budget"]["terms"]["estimator"][part].get<double>(),
                clean["budget"]["terms"]["estimator"][part].get<double>(), 5e-7)
        << part;
  }
  EXPECT_GT(errors["budget"]["terms"]["noise"]["rms_px"].get<double>(),
            2 * clean["budget"]["terms"]["noise"]["rms_px"].get<double>());
  EXPECT_EQ(dataset("spoilt/truth.h5", "/particles/displacement_px").size(),
            dataset("case/truth.h5", "/particles/displacement_px").size());
  Image<double> const picture = read_image(in("spoilt/reference.tif").string());
  EXPECT_GT(*std::min_element(picture.begin(), picture.end()), 0);
  render("again", {}, "spoilt/setup.toml");
  EXPECT_EQ(nlohmann::json::parse(read("again/summary.json"))["flow_sha256"],
            nlohmann::json::parse(read("spoilt/summary.json"))["flow_sha256"]);
}

// Views of a plenoptic image, and a refocused image, are written next to its case; other cases contain none.
TEST_F(Piv, ExtractsViewsOfAPlenopticPicture) {
  std::string const plenoptic =
      with(with(with(piv_setup, "pixel_pitch_um = 10.0\n",
                     "pixel_pitch_um = 5.0\n[camera.lenslets]\npitch_um = 65\nfocal_length_um = 280\n"),
                "f_number = 22.0", "f_number = 4.0"),
           "[correlate]", "[render]\nrays_per_dot = 32\n[correlate]");
  write("setup.toml", plenoptic);
  render("case");
  auto const json = json_of({"views", "case", "--refocus", "3", "--quiet"});
  EXPECT_EQ(json["views"].size(), 21u);
  EXPECT_NEAR(json["lenslet_pictures_px"].get<double>(), 12.04, 0.01);
  EXPECT_EQ(names("case/views"), (std::vector<std::string>{"flow", "flow_refocused.tif", "reference",
                                                           "reference_refocused.tif", "views.json"}));
  EXPECT_EQ(names("case/views/flow").size(), 21u);
  auto const written = nlohmann::json::parse(read("case/views/views.json"));
  EXPECT_EQ(written["lenslet_pictures_px"], json["lenslet_pictures_px"]);
  EXPECT_NEAR(written["refocused_z_mm"].get<double>(), 3, 1e-12);
  EXPECT_GT(std::abs(written["parallax_px_per_mm"].get<double>()), 0);
  for (auto const& view : written["views"]) {
    EXPECT_TRUE(fs::exists(in("case/views/flow/" + view["file"].get<std::string>()))) << view;
    ASSERT_EQ(view["stop_mm"].size(), 2u);
    EXPECT_LT(std::hypot(view["stop_mm"][0].get<double>(), view["stop_mm"][1].get<double>()), 105.0 / 4 / 2) << view;
  }
  // 128 px of 5 um show 9 lenslets of 65 um
  EXPECT_EQ(read_image(in("case/views/flow/view_02_02.tif").string()).columns(), 9);
  EXPECT_THAT(succeed({"views", "case", "--views", "3", "-o", "three"}), ContainsWhole("9 views of 9 x 9 px"));
  // a link to an input of the command is not replaced
  std::filesystem::create_hard_link(in("case/flow.tif"), in("three/flow_refocused.tif"));
  expect_error({"views", "case", "--views", "3", "-o", "three", "--quiet"}, 2,
               "overwrites_input at flow_refocused.tif");
  // The stop is 12.04 px wide: 13 views across contain all information, more than twice as many give a warning
  auto const enough = json_of({"views", "case", "--views", "13", "-o", "enough"});
  EXPECT_THAT(warnings_in(enough), testing::Not(testing::Contains("unsuitable at --views")));
  auto const many = json_of({"views", "case", "--views", "25", "-o", "many", "--quiet"});
  expect_warning_in(many, "unsuitable at --views", {"12 px", "--views 13"});
  write("plain.toml", piv_setup);
  render("plain", {}, "plain.toml");
  expect_error({"views", "plain"}, 2, "unsupported at setup.toml");
  expect_error({"views", "case", "--refocus", "700"}, 2, "out_of_range at --refocus");
}

TEST_F(Piv, RefusesMoreParticlesThanMemoryHolds) {
  std::string const absurd = with(piv_setup, "per_pixel = 0.05", "number = 3.9e9");
  expect_setup_error(absurd, "memory at setup.toml:" + place_of(absurd, "number = 3.9e9"));
  expect_setup_error(with(piv_setup, "dt_us = 10.0", "dt_us = 0.0"), "out_of_range at setup.toml:25:1");
}

}  // namespace
}  // namespace gladstone::end_to_end
