#include <cmath>

#include "tests/end_to_end/support/workplace.h"

namespace gladstone::end_to_end {
namespace {

namespace fs = std::filesystem;

/// White spheres in a sheet that move by 2.3 px: at M = 105 / 645 and 10 um that is 141.2857 um in 10 us.
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

class Piv : public Workplace {
 protected:
  void SetUp() override {
    Workplace::SetUp();
    write("setup.toml", piv_setup);
  }
  std::vector<double> dataset(std::string const& file, std::string const& name) const {
    return Hdf5Reader(in(file).string()).read(name);
  }
  /// Renders, correlates, compares; errors.json.
  nlohmann::json errors_of(std::string const& setup) const {
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
  auto const errors = errors_of(piv_setup);
  // noise-free, and only 13 particles a window: the correlator is good to 0.02 px
  EXPECT_NEAR(errors["ray_truth"]["bias_u_px"].get<double>(), 0, 0.02);
  EXPECT_LT(errors["ray_truth"]["rms_px"].get<double>(), 0.02);
  EXPECT_GT(errors["ray_truth"]["valid_fraction"].get<double>(), 0.9);
  // the flow is what it is in the sheet's middle, and nothing refracts
  EXPECT_NEAR(errors["budget"]["terms"]["projection"]["rms_px"].get<double>(), 0, 1e-5);
  EXPECT_EQ(errors["budget"]["terms"]["refraction"]["rms_px"].get<double>(), 0);
  EXPECT_LT(errors["budget"]["closure_px"].get<double>(), 1e-9);
  EXPECT_TRUE(errors["eq9"].is_null());
  auto const truth = dataset("case/truth.h5", "/particles/displacement_px");
  auto const place = dataset("case/truth.h5", "/particles/position_m");
  for (std::size_t i = 0; i < truth.size() / 2; ++i) {
    if (std::isnan(truth[2 * i])) continue;
    double const expected = 2.3 * 750e-3 / (750e-3 - place[3 * i + 2]);  // nearer to the lens it is larger
    EXPECT_NEAR(truth[2 * i], expected, 1e-3);
    EXPECT_NEAR(truth[2 * i + 1], 0, 1e-3);
  }
}

// A vortex of up to 3 px, its axis in the view's middle. Central displacement: particles that are at a vector at
// mid-time have moved by the flow there times dt, to the curvature of their paths, (angle of the turn)^2 / 24; the
// angle is 0.13 at most. Those that start there would be off by half of that angle, 7 %.
TEST_F(Piv, ComparesAVortexWithItsFlow) {
  std::string const vortex = with(piv_setup, "velocity_m_s = [14.12857, 0.0, 0.0]",
                                  "kind = \"lamb_oseen\"\ncirculation_m2_s = 0.32\ncore_radius_mm = 2.0");
  auto const errors = errors_of(vortex);
  auto const& terms = errors["budget"]["terms"];
  EXPECT_LT(terms["projection"]["rms_px"].get<double>(), 3 * 0.13 * 0.13 / 24);
  EXPECT_LT(errors["ambient_truth"]["rms_px"].get<double>(), 0.15);
  EXPECT_EQ(errors["ambient_truth"], errors["ray_truth"]);
  double const at_mid = terms["projection"]["rms_px"].get<double>();
  auto const reference = json_of({"compare", "case", "--quiet", "--no-figures", "--truth-at", "reference"});
  EXPECT_GT(reference["budget"]["terms"]["projection"]["rms_px"].get<double>(), 10 * at_mid);
}

// Electrons of the whole picture are photons times quantum efficiency; a level is full_well_e over full scale. Levels
// are whole numbers: what is rounded away below half of one is little beside 2000 electrons.
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

// Two cameras 20 degrees to either side see the very same particles.
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
  // motion along X is seen at the cosine of the angle by both; motion along Z, opposite
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
  // 0.1 mm towards the cameras; the left one's right is (cos 20, 0, sin 20 degrees): 0.1 * 0.342 * 16.28 px/mm
  EXPECT_NEAR(mean("deep/left/truth.h5"), 0.557, 0.02);
  EXPECT_NEAR(mean("deep/right/truth.h5"), -0.557, 0.02);
}

// A study over the time between the pulses: truth grows with it.
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

TEST_F(Piv, RefusesMoreParticlesThanMemoryHolds) {
  std::string const absurd = with(piv_setup, "per_pixel = 0.05", "number = 3.9e9");
  expect_setup_refused(absurd, {"setup.toml:" + place_of(absurd, "number = 3.9e9"), "GB of memory"});
  expect_setup_refused(with(piv_setup, "dt_us = 10.0", "dt_us = 0.0"), {"dt_us = 0.0", "greater than 0"});
}

}  // namespace
}  // namespace gladstone::end_to_end
