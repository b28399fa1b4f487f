#include <cmath>

#include "tests/end_to_end/support/program_fixture.h"

namespace gladstone::end_to_end {
namespace {

using testing::AllOf;
using testing::HasSubstr;

constexpr char const* particle_setup = R"(experiment = "piv"
[camera]
pixels = [128, 128]
pixel_pitch_um = 10.0
[lens]
f_number = 22.0
[geometry]
z_a_mm = 750.0
[particles]
number = 800
volume_mm = [10.0, 10.0, 1.5]
[laser]
thickness_mm = 1.0
[flow]
velocity_m_s = [14.0, -6.0, 0.0]
dt_us = 10.0
[render]
rays_per_dot = 32
[correlate]
window_px = [32, 16]
overlap = 0.5
)";

/// correlate.method = "tracking" from rendering to comparison.
class TrackedDots : public ProgramFixture {
 protected:
  /// Correlates a case by tracking.
  nlohmann::json track(std::string const& output, std::string const& file) const {
    return json_of({"correlate", "case", "-o", file, "--set", "correlate.method=tracking", "--set",
                    "correlate.tracking.output=" + output});
  }
  nlohmann::json compare(std::string const& file) const {
    return json_of({"compare", "case", "--no-figures", "--vectors", file});
  }
  std::size_t finite_values(std::string const& file, char const* dataset) const {
    std::vector<double> const values = Hdf5Reader(in(file).string()).read(dataset);
    return static_cast<std::size_t>(
        std::count_if(values.begin(), values.end(), [](double v) { return std::isfinite(v); }));
  }

  /// Tracks a case on the grid and at the dots, and compares both with the truth.
  /// @param least_valid  smallest share of valid vectors
  /// @param most_px      largest rms error against the truth
  void expect_tracked(double least_valid, double most_px) const {
    for (std::string const output : {"grid", "scattered"}) {
      std::string const file = output + ".h5";
      auto const tracked = track(output, file);
      EXPECT_EQ(tracked["verdict_code"], "correlates") << output;
      double const vectors = tracked["vectors"], valid = tracked["valid"];
      EXPECT_GT(valid, least_valid * vectors) << output;
      EXPECT_EQ(tracked["replaced"], 0) << output;
      Hdf5Reader const written(in(file).string());
      EXPECT_EQ(written.attribute("grid_columns").empty(), output == "scattered");
      EXPECT_THAT(written.attribute("setup"), AllOf(HasSubstr("[correlate.tracking]"), HasSubstr(output)));
      EXPECT_EQ(finite_values(file, "/sigma_u_px"), static_cast<std::size_t>(valid)) << output;
      auto const errors = compare(file);
      EXPECT_EQ(errors["vectors"]["total"], tracked["vectors"]) << output;
      double const rms = errors["ray_truth"]["rms_px"];
      EXPECT_LT(rms, most_px) << output;
      EXPECT_GT(errors["ray_truth"]["valid_fraction"], 0.95 * least_valid) << output;
      if (output == "scattered") {
        EXPECT_EQ(errors["window_truth"]["rms_px"], errors["ray_truth"]["rms_px"]);
      }
    }
  }
};

// The displacement is nearly uniform: the errors are those of dots.
TEST_F(TrackedDots, OfATargetFollowTheTruth) {
  write("setup.toml", automatic_setup());
  render("case", {"--set", "camera.pixels=[128, 128]"});
  expect_tracked(0.9, 0.02);
}

TEST_F(TrackedDots, OfAFlowFollowTheTruth) {
  write("setup.toml", particle_setup);
  render("case");
  expect_tracked(0.8, 0.03);
}

// Shot noise of 30000 electrons at full scale exceeds the noise of the dark background many times at the particles. A
// standard uncertainty covers 68 % of normal errors; about 700 components scatter by 2 %.
TEST_F(TrackedDots, HaveAnUncertaintyThatContainsShotNoise) {
  write("setup.toml", particle_setup);
  render("case", {"--set", "camera.noise.full_well_e=30000"});
  track("scattered", "noisy.h5");
  double const coverage = compare("noisy.h5")["uncertainty"]["ray_truth"]["coverage_1"];
  EXPECT_GT(coverage, 0.58);
  EXPECT_LT(coverage, 0.8);
}

// Scattered vectors as text, and as an axis of a study.
TEST_F(TrackedDots, ServeEveryCommandThatReadsVectors) {
  write("setup.toml",
        std::string(small_setup) + "method = \"tracking\"\n[correlate.tracking]\noutput = \"scattered\"\n");
  render("case", {"--set", "camera.pixels=[96, 96]"});
  succeed({"correlate", "case"});
  succeed({"correlate", "case", "-o", "v.csv"});
  auto const errors = compare("v.csv");
  EXPECT_LT(errors["ray_truth"]["rms_px"], 0.05);
  succeed({"compare", "case", "--no-figures"});
  write("study.toml", "base = \"setup.toml\"\n[axes]\n\"correlate.tracking.output\" = [\"grid\", \"scattered\"]\n");
  succeed({"sweep", "plan", "study.toml", "-o", "study", "--device", "cpu", "--quiet"});
  succeed({"sweep", "run", "study", "--quiet"});
  EXPECT_EQ(json_of({"sweep", "status", "study"})["done"], 2);
}

TEST_F(TrackedDots, NeedValidKeys) {
  auto const refused = [&](std::string const& tables, std::string const& error,
                           std::vector<std::string> const& values = {}) {
    expect_setup_error(std::string(small_setup) + tables, error, values);
  };
  std::string const tracking = "method = \"tracking\"\n";
  refused(tracking + "[correlate.tracking]\npolarity = \"grey\"", "unknown_choice at setup.toml:32:1",
          {"polarity", "\"bright\""});
  refused(tracking + "[correlate.tracking]\nshape = \"square\"", "unknown_choice at setup.toml:32:1",
          {"shape", "\"elliptic\""});
  refused(tracking + "[correlate.tracking]\noutput = \"cells\"", "unknown_choice at setup.toml:32:1",
          {"output", "\"scattered\""});
  refused(tracking + "[correlate.tracking]\ndiameter = 3", "unknown_key at setup.toml:32:1",
          {"\"diameter\"", "diameter_px"});
  refused(tracking + "[correlate.tracking]\ndiameter_px = 0", "out_of_range at setup.toml:32:1", {"diameter_px"});
  refused(tracking + "[correlate.tracking]\nsearch_radius_px = -1", "out_of_range at setup.toml:32:1",
          {"search_radius_px"});
  refused(tracking + "[correlate.tracking]\ndisplacement_bound_px = 0", "out_of_range at setup.toml:32:1",
          {"displacement_bound_px"});
  refused(tracking + "uncertainty = \"peak_ratio\"", "invalid_value at setup.toml:31:1",
          {"uncertainty", "method = \"tracking\""});
}

TEST_F(TrackedDots, AreMissingFromFlatFrames) {
  Image<std::uint16_t> const flat(64, 64, 1000);
  for (char const* name : {"a.tif", "b.tif"}) write_tiff(in(name).string(), flat, {});
  for (std::string const output : {"grid", "scattered"}) {
    Outcome const outcome =
        gladstone({"correlate", "a.tif", "b.tif", "-o", "v.h5", "--set", "correlate.window_px=[32]", "--set",
                   "correlate.method=tracking", "--set", "correlate.tracking.output=" + output, "--json"});
    EXPECT_EQ(outcome.exit_code, 1) << outcome.err;
    EXPECT_THAT(warnings_in(nlohmann::json::parse(outcome.out)), testing::Contains("unreliable"));
  }
  expect_error({"correlate", "--ensemble", "a.tif", "b.tif", "-o", "w.h5", "--set", "correlate.method=tracking",
                "--set", "correlate.window_px=[32]"},
               2, "unsupported at ensemble");
}

}  // namespace
}  // namespace gladstone::end_to_end
