#include "render/light/laser_sheet.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "render/base/error.h"
#include "render/base/gauss_legendre.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

/// Reads the keys of a table [laser].
LaserSetup read_laser(std::string const& keys) {
  SetupDocument document = SetupDocument::from_text("[laser]\n" + keys, "case.toml");
  LaserSetup const laser = read_laser_setup(document.root().table("laser"), 532e-9);
  document.finish();
  return laser;
}

/// Returns the energy of a pulse through the plane at distance `along` from the sheet's centre, perpendicular to its
/// axis [J]. The fluence refers to an area perpendicular to the light, which is inclined to the plane's normal in a
/// diverging sheet.
double energy_through(LaserSheet<double> const& sheet, int pulse, double along) {
  GaussLegendre const rule(60);
  Pose<double> const pose = sheet.pose[pulse];
  double const half_height = (sheet.height + along * sheet.growth) / 2;
  // Beyond three widths, exp(-72) of a Gaussian remains; a top-hat is integrated between its edges.
  double const half_depth = sheet.profile == SheetProfile::gaussian ? 3 * sheet.thickness : sheet.thickness / 2;
  double sum = 0;
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    for (std::size_t j = 0; j < rule.node.size(); ++j) {
      Vec3d const point = pose.point_to_outer({along, half_height * rule.node[i], half_depth * rule.node[j]});
      sum += rule.weight[i] * rule.weight[j] * sheet.fluence(point, pulse) *
             dot(sheet.wave(point, pulse).propagation, pose.x);
    }
  }
  return sum * half_height * half_depth;
}

// The energy of a pulse is the same through every plane perpendicular to the axis, for any profile, divergence and
// position. 60 nodes integrate exp(-8 z^2/w^2) over 6 w to 1e-10.
TEST(LaserSheet, IntegratesToThePulseEnergy) {
  for (char const* const profile : {"gaussian", "top_hat"}) {
    for (double const divergence : {0.0, 20.0, -10.0}) {
      LaserSetup const setup =
          read_laser(std::string("profile = \"") + profile + "\"\ndivergence_deg = " + std::to_string(divergence) +
                     "\ndirection = [1, 2, 0.5]\nnormal = [0, -0.25, 1]\ncenter_mm = [3, 4, 5]\n"
                     "offset_mm = [0.2, -0.3]\ntilt_deg = [0, 3]\npulse_energy_mj = 80");
      LaserSheet<double> const sheet = laser_sheet(setup);
      for (int const pulse : {0, 1}) {
        for (double const along : {-0.02, 0.0, 0.05}) {
          EXPECT_NEAR(energy_through(sheet, pulse, along), 80e-3, 1e-9 * 80e-3) << profile << " " << divergence;
        }
      }
    }
  }
}

// In the middle of a Gaussian sheet, the fluence is E/(h w sqrt(pi/8)): 1994.71 J/m^2 for 50 mJ in 40 mm by 1 mm. At
// half a width from the middle, it is e^-2 of that; beyond the height, it is zero.
TEST(LaserSheet, GaussianHasItsPeakAndWidth) {
  LaserSheet<double> const sheet = laser_sheet(read_laser(""));
  EXPECT_NEAR(sheet.fluence({0, 0, 0}, 0), 1994.71, 0.005);
  EXPECT_NEAR(sheet.fluence({0, 0, 0}, 0), 50e-3 / (40e-3 * 1e-3 * std::sqrt(pi / 8)), 1e-9);
  EXPECT_NEAR(sheet.fluence({0.01, 0.003, 0.5e-3}, 0) / sheet.fluence({0, 0, 0}, 0), std::exp(-2.0), 1e-12);
  EXPECT_GT(sheet.fluence({0, 19.9e-3, 0}, 0), 0);
  EXPECT_EQ(sheet.fluence({0, 20.1e-3, 0}, 0), 0);
  EXPECT_EQ(sheet.fluence({0, -20.1e-3, 0}, 0), 0);
  // h c / lambda = 3.7340e-19 J
  EXPECT_NEAR(sheet.photons({0, 0, 0}, 0) / (1994.711 / (6.62607015e-34 * 299792458.0 / 532e-9)), 1, 1e-6);
}

TEST(LaserSheet, TopHatHasEdges) {
  LaserSheet<double> const sheet = laser_sheet(read_laser("profile = \"top_hat\"\nthickness_mm = 2"));
  double const inside = 50e-3 / (40e-3 * 2e-3);
  EXPECT_DOUBLE_EQ(sheet.fluence({0, 0, 0.99e-3}, 0), inside);
  EXPECT_DOUBLE_EQ(sheet.fluence({0.3, 0.01, -0.99e-3}, 0), inside);
  EXPECT_EQ(sheet.fluence({0, 0, 1.01e-3}, 0), 0);
  EXPECT_EQ(sheet.fluence({0, 0, -1.01e-3}, 0), 0);
}

// Each pulse has its own offset along the normal and its own right-handed rotation about the laser's direction: a
// tilted sheet illuminates (y cos t, y sin t).
TEST(LaserSheet, PulsesHaveTheirOwnPlaceAndTilt) {
  LaserSheet<double> const sheet = laser_sheet(read_laser("offset_mm = [0.4, -0.1]\ntilt_deg = [0.0, 5.0]"));
  double const peak = 1994.711402007;
  EXPECT_NEAR(sheet.fluence({0, 0.01, 0.4e-3}, 0), peak, 1e-3);
  double const tilt = 5 * unit::degree;
  EXPECT_NEAR(sheet.fluence({0, 0.01 * std::cos(tilt), -0.1e-3 + 0.01 * std::sin(tilt)}, 1), peak, 1e-3);
  EXPECT_LT(sheet.fluence({0, 0.01, -0.1e-3}, 1), 0.1 * peak);
}

// A sheet with a divergence of 20 degrees widens by 2 tan(10 deg) per length, and the fluence on the axis decreases
// accordingly. The light travels along lines from the origin of the fan, and its electric field is perpendicular to
// them.
TEST(LaserSheet, FansOut) {
  LaserSheet<double> const sheet = laser_sheet(read_laser("divergence_deg = 20\npolarization_deg = 30"));
  double const half = std::tan(10 * unit::degree), grown = 40e-3 + 2 * half * 0.1;
  EXPECT_NEAR(sheet.fluence({0.1, 0, 0}, 0) / sheet.fluence({0, 0, 0}, 0), 40e-3 / grown, 1e-12);
  EXPECT_GT(sheet.fluence({0.1, 0.499 * grown, 0}, 0), 0);
  EXPECT_EQ(sheet.fluence({0.1, 0.501 * grown, 0}, 0), 0);
  double const origin = -20e-3 / half;
  EXPECT_EQ(sheet.fluence({origin - 0.01, 0, 0}, 0), 0);  // upstream of the fan's origin
  for (Vec3d const point : {Vec3d{0, 0, 0}, Vec3d{0, 0.02, 0}, Vec3d{0.1, -0.03, 1e-4}}) {
    LightWave<double> const wave = sheet.wave(point, 0);
    Vec3d const way = normalized(Vec3d{point.x - origin, point.y, 0});
    EXPECT_LT(length(wave.propagation - way), 1e-12);
    EXPECT_NEAR(dot(wave.propagation, wave.field), 0, 1e-15);
    EXPECT_NEAR(length(wave.field), 1, 1e-15);
    EXPECT_NEAR(wave.field.z, std::sin(30 * unit::degree), 1e-12);
  }
}

// For light along X in a sheet perpendicular to Z, the electric field is along Y at 0 degrees and along Z at 90. The
// cosine of 90 degrees is 6e-17, and each of the few products and sums of unit vectors rounds by 1.1e-16.
TEST(LaserSheet, PolarisationTurnsOutOfTheSheet) {
  EXPECT_LT(length(laser_sheet(read_laser("")).wave({0, 0, 0}, 0).field - Vec3d{0, 1, 0}), 1e-15);
  EXPECT_LT(length(laser_sheet(read_laser("polarization_deg = 90")).wave({0, 0, 0}, 1).field - Vec3d{0, 0, 1}), 1e-15);
}

// A sheet of 50 mJ, 40 mm by 1 mm, at 532 nm illuminates a droplet of 1 um in its middle, seen perpendicularly through
// a lens of 105 mm, f/8, at 0.75 m: 45,443 photons, and 27,267 electrons at a quantum efficiency of 0.6. Since S1
// varies over the lens, the tolerance is 1 %.
TEST(LaserSheet, DropletSendsItsPhotonsThroughALens) {
  LaserSheet<double> const sheet = laser_sheet(read_laser(""));
  MieScattering const scattering({1e-6}, {}, {1.5, 1.64});
  LightWave<double> const wave = sheet.wave({0, 0, 0}, 0);
  auto const view = scattering.view();
  double const distance = 0.75, radius = 105e-3 / 8 / 2, half_angle = std::atan(radius / distance);
  GaussLegendre const rule(20);
  int const turns = 40;
  double photons = 0, solid_angle = 0;
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    double const cosine = 1 - (1 - std::cos(half_angle)) * (rule.node[i] + 1) / 2;
    double const sine = std::sqrt(1 - cosine * cosine);
    double const share = (1 - std::cos(half_angle)) / 2 * rule.weight[i] * 2 * pi / turns;
    for (int turn = 0; turn < turns; ++turn) {
      double const phi = 2 * pi * turn / turns;
      photons += share * sheet.photons({0, 0, 0}, 0) *
                 view.cross_section(0, {sine * std::cos(phi), sine * std::sin(phi), cosine}, wave);
      solid_angle += share;
    }
  }
  // The solid angle of the lens is its area over the square of its distance, 2.40528e-4 sr, up to a relative error of
  // 3/4 (radius/distance)^2.
  EXPECT_NEAR(solid_angle, 2.40528e-4 * (1 - 0.75 * std::pow(radius / distance, 2)), 1e-9);
  EXPECT_NEAR(photons, 45443, 454);
  EXPECT_NEAR(0.6 * photons, 27267, 272);
}

// All errors in a table [laser] are reported together, each with its location and remedy.
TEST(LaserSheet, RefusesWhatIsNoSheet) {
  EXPECT_EQ(error_of([] {
              read_laser("thickness_mm = 0.0\npulse_energy_mj = -5.0\nnormal = [2.0, 0.0, 0.0]\nheight_mm = -1.0");
            }),
            "out_of_range at case.toml:2:1, out_of_range at case.toml:3:1, invalid_value at case.toml:4:1, "
            "out_of_range at case.toml:5:1");
  EXPECT_THAT([] { read_laser("direction = [0.0, 0.0, 0.0]"); },
              ThrowsSetupError(ErrorCode::invalid_value, "laser.direction"));
  EXPECT_THAT([] { read_laser("direction = [1.0, 0.0, 1.0]"); },
              ThrowsSetupError(ErrorCode::invalid_value, "laser.direction"));
  EXPECT_THAT([] { read_laser("profile = \"gausian\""); },
              ThrowsSetupError(ErrorCode::unknown_choice, "laser.profile"));
  EXPECT_THAT([] { read_laser("thicknes_mm = 1.0"); }, ThrowsSetupError(ErrorCode::unknown_key, "laser.thicknes_mm"));
  // directions with rounded components are accepted as perpendicular, and made exactly so
  LaserSetup const rounded = read_laser("direction = [0.707, 0.0, 0.707]\nnormal = [-0.7, 0.0, 0.71]");
  EXPECT_NEAR(dot(rounded.direction, rounded.normal), 0, 1e-15);
}

}  // namespace
}  // namespace gladstone
