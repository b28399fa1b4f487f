#include "studies/case/expected_particles.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "render/base/units.h"
#include "studies/case/case.h"

namespace gladstone {
namespace {

/// Droplets of 1 um in a sheet of 50 mJ, 40 mm by 1 mm, seen perpendicularly through a lens of 105 mm, f/8, at 0.75 m.
constexpr char const* droplet_setup = R"(schema = 1
experiment = "piv"
[camera]
pixels = [512, 512]
pixel_pitch_um = 5.0
exposure = "absolute"
noise = { read_noise_e = 10.0, full_well_e = 40000.0, quantum_efficiency = 0.6 }
[lens]
focal_length_mm = 105.0
f_number = 8.0
[geometry]
z_a_mm = 750.0
[medium.field]
kind = "none"
[particles]
number = 20000
volume_mm = [40.0, 40.0, 3.0]
diameter_um = 1.0
[laser]
pulse_energy_mj = 50.0
[flow]
kind = "uniform"
velocity_m_s = [1.0, 0.0, 0.0]
dt_us = 10.0
)";

ExpectedParticles expectation(std::string const& old = "", std::string const& replacement = "") {
  std::string text = droplet_setup;
  if (!old.empty()) text.replace(text.find(old), old.size(), replacement);
  return expected_particles(load_case_setup(SetupDocument::from_text(text, "piv.toml")).setup);
}

/// Its optical parameters [m].
struct DropletOptics {
  static constexpr double f = 105e-3, distance = 0.75, pitch = 5e-6, number = 8, lambda = 532e-9;
  static constexpr double magnification = f / (distance - f);
};

class ExpectedOfDroplets : public testing::Test, protected DropletOptics {};

// Photons of the droplet: fluence 1994.71 J/m^2, |S1(90 deg)|^2 = 4.933372, 2.40528e-4 sr: 45,443 photons, and 0.6
// times as many electrons. Tolerance 1 %: S1 and the solid angle vary over the lens, and the index of air is not
// exactly 1.
TEST_F(ExpectedOfDroplets, CountPhotonsAndElectrons) {
  ExpectedParticles const expected = expectation();
  EXPECT_NEAR(expected.photons.median, 45443, 454);
  EXPECT_EQ(expected.photons.p05, expected.photons.p95);  // one diameter
  double const sigma = expected.image_diameter_px / 4;
  double const share = std::pow(std::erf(0.5 / (std::sqrt(2.0) * sigma)), 2);
  EXPECT_NEAR(expected.peak_electrons.median, 27267 * share, 272 * share);
  EXPECT_EQ(expected.saturated, 0);
  EXPECT_EQ(expectation("full_well_e = 40000.0", "full_well_e = 3000.0").saturated, 1);
}

// In focus the diameter is sqrt((M d)^2 + (1.682 N (1 + M) lambda)^2), and the depth of field 4.88 ((M + 1)/M)^2 N^2
// lambda. Half a millimetre closer, the circle of confusion M D z/(Z - z) is added.
TEST_F(ExpectedOfDroplets, HaveTheirDiameter) {
  ExpectedParticles const expected = expectation();
  EXPECT_NEAR(expected.magnification, magnification, 1e-12);
  double const diffraction = 4 * 0.4206042622 * number * (1 + magnification) * lambda / pitch;
  EXPECT_NEAR(expected.diffraction_px, diffraction, 1e-9);
  EXPECT_NEAR(expected.image_diameter_px, std::hypot(diffraction, magnification * 1e-6 / pitch), 1e-9);
  EXPECT_NEAR(expected.depth_of_field, 4.88 * std::pow((magnification + 1) / magnification * number, 2) * lambda,
              1e-12);
  double const blur = magnification * f / number * 0.5e-3 / (distance - 0.5e-3) / pitch;
  EXPECT_NEAR(expected.sheet_edge_diameter_px, std::hypot(expected.image_diameter_px, blur), 1e-9);
  // 30 mm out of focus all are wider, at the magnification of the plane in focus
  ExpectedParticles const blurred = expectation("f_number = 8.0", "f_number = 8.0\nfocus_distance_mm = 720.0");
  double const focused = f / (0.72 - f), disc = focused * f / number * 0.03 / 0.75 / pitch;
  double const spot = 4 * 0.4206042622 * number * (1 + focused) * lambda / pitch;
  EXPECT_NEAR(blurred.image_diameter_px, std::sqrt(spot * spot + disc * disc), 1e-3 * disc);
}

// 20000 in 40 x 40 x 3 mm are 4.1667 per cubic millimetre; a pixel sees (p/M)^2 of the illuminated millimetre. A volume
// thinner than the sheet is illuminated completely.
TEST_F(ExpectedOfDroplets, AreSoManyAWindow) {
  double const seen = std::pow(pitch / magnification * 1e3, 2);  // [mm^2]
  ExpectedParticles const expected = expectation();
  EXPECT_NEAR(expected.per_pixel, 20000.0 / 4800 * seen, 1e-9);
  EXPECT_NEAR(expected.source_density, expected.per_pixel * pi / 4 * std::pow(expected.image_diameter_px, 2), 1e-12);
  EXPECT_NEAR(expectation("40.0, 3.0]", "40.0, 0.5]").per_pixel, 20000.0 / 1600 * seen, 1e-9);
  // the middle of the sheet at the face of the volume, 1.5 mm closer to the camera: half of it is inside
  double const nearer = std::pow((distance - 1.5e-3) / distance, 2);
  EXPECT_NEAR(expectation("pulse_energy_mj = 50.0", "offset_mm = [1.5, 1.5]").per_pixel,
              20000.0 / 4800 / 2 * seen * nearer, 1e-9);
  EXPECT_NEAR(expectation("number = 20000", "per_mm3 = 2.0").per_pixel, 2 * seen, 1e-9);
}

// The peak of the smallest visible particle is five times its noise, S = 5 sqrt(S + r^2): 64.0 e at r = 10 e. Below the
// wavelength the light decreases steeply with size, finally as d^6, so that a step of the search, 1.5 % in size, is
// less than 10 % of the light.
TEST_F(ExpectedOfDroplets, KnowTheSmallestThatIsSeen) {
  ExpectedParticles const expected = expectation();
  double const needed = (25 + std::sqrt(625 + 4 * 25 * 100.0)) / 2;
  EXPECT_LT(expected.smallest_visible, 0.5e-6);
  ExpectedParticles const just =
      expectation("diameter_um = 1.0", "diameter_um = " + std::to_string(expected.smallest_visible * 1e6 + 5e-7));
  EXPECT_GE(just.peak_electrons.median, 0.999 * needed);
  EXPECT_LE(just.peak_electrons.median, 1.1 * needed);
  // a hundred times the energy would reduce the diameter by 100^(1/6) in the Rayleigh regime; here it reduces it by
  // less
  EXPECT_LT(expectation("pulse_energy_mj = 50.0", "pulse_energy_mj = 5000.0").smallest_visible,
            expected.smallest_visible);
}

// A distribution of sizes gives a distribution of light: 90 % of a log-normal distribution lie within exp(+-1.645
// sigma), to 2 % for 4001 samples.
TEST_F(ExpectedOfDroplets, SpreadWithTheirSizes) {
  ExpectedParticles const expected =
      expectation("diameter_um = 1.0", "diameter_um = { kind = \"lognormal\", median_um = 1.0, sigma = 0.3 }");
  EXPECT_NEAR(expected.diameter.median, 1e-6, 2e-8);
  EXPECT_NEAR(expected.diameter.p95, 1e-6 * std::exp(1.645 * 0.3), 5e-8);
  EXPECT_NEAR(expected.diameter.p05, 1e-6 * std::exp(-1.645 * 0.3), 3e-8);
  EXPECT_LT(expected.photons.p05, 0.5 * expected.photons.median);
  EXPECT_GT(expected.photons.p95, 2 * expected.photons.median);
}

}  // namespace
}  // namespace gladstone
