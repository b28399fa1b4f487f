#include "render/light/mie_scattering.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/base/random.h"
#include "render/light/mie.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr double micrometre = unit::micrometre;

/// Oil in air, green light.
MieSetting droplets() { return {}; }

/// Light along X with its electric field along Y.
constexpr LightWave<double> along_x;

/// Returns the unit vector at an angle from X, rotated about X by phi from Y towards Z.
Vec3d towards(double angle, double phi) {
  return {std::cos(angle), std::sin(angle) * std::cos(phi), std::sin(angle) * std::sin(phi)};
}

double wave_number(MieSetting const& setting) { return 2 * pi * setting.surroundings / setting.wavelength; }

/// Returns different diameters, distributed approximately log-normally with a median of 1 um.
std::vector<double> many_diameters(std::size_t count) {
  std::vector<double> diameters;
  for (std::uint64_t i = 0; i < count; ++i) {
    double const u = to_unit(random_bits(5, RandomStream::target, i, 0)),
                 v = to_unit(random_bits(5, RandomStream::target, i, 1));
    diameters.push_back(micrometre * std::exp(0.3 * (u + v - 1) * std::sqrt(6.0)));
  }
  return diameters;
}

// For light along X seen along Z (Bohren & Huffman sec. 3.3), the sphere scatters |S1|^2/k^2 if the field is along Y,
// perpendicular to the scattering plane, and |S2|^2/k^2 if it is along Z, in that plane; in between, the two are
// weighted by cos^2 and sin^2.
TEST(MieScattering, SeesTheFieldAcrossByS1AndInThePlaneByS2) {
  MieScattering const scattering({micrometre}, droplets(), {1.2, 2.0});
  MieCoefficients const sphere(pi / 0.532, 1.45);
  double const k = wave_number(droplets());
  auto const [s1, s2] = sphere.amplitudes(pi / 2);
  for (double const polarization : {0.0, 0.3, pi / 4, pi / 2}) {
    LightWave<double> const wave{{1, 0, 0}, {0, std::cos(polarization), std::sin(polarization)}};
    double const expected =
        (std::norm(s1) * std::pow(std::cos(polarization), 2) + std::norm(s2) * std::pow(std::sin(polarization), 2)) /
        (k * k);
    // error() refers to the mean, which is similar to the value at 90 degrees
    EXPECT_NEAR(scattering.view().cross_section(0, {0, 0, 1}, wave) / expected, 1, 5 * scattering.error());
  }
}

// Symmetries of a sphere: rotating light and camera together, or mirroring the light in a plane that contains the
// field, does not change the intensity. Two perpendicular fields together scatter twice as much as unpolarised light.
TEST(MieScattering, TurnsWithTheLight) {
  MieSetting const setting = droplets();
  MieScattering const scattering({1.7 * micrometre}, setting, {0, pi});
  auto const view = scattering.view();
  Pose<double> const turned = Pose<double>{}.turned({0.3, -1.1, 2.0});
  LightWave<double> const other{turned.direction_to_outer(along_x.propagation),
                                turned.direction_to_outer(along_x.field)};
  LightWave<double> const crossed{along_x.propagation, {0, 0, 1}};
  double const k = wave_number(setting);
  MieCoefficients const sphere(1.7 * pi / 0.532, 1.45);
  // error of the table relative to the mean cross-section
  double const mean = sphere.efficiencies().q_sca * pow(1.7 * micrometre, 2) / 16;
  for (double const angle : {0.0, 0.2, 1.0, 1.9, 3.0, pi}) {
    for (double const phi : {0.0, 0.5, 2.0, 4.0}) {
      Vec3d const direction = towards(angle, phi);
      double const seen = view.cross_section(0, direction, along_x);
      // In forward and backward direction, |S1| and |S2| are equal up to the rounding of their float coefficients.
      double const rounding = 2e-7 * seen + 1e-9 * mean;
      EXPECT_NEAR(view.cross_section(0, turned.direction_to_outer(direction), other), seen, rounding);
      EXPECT_NEAR(view.cross_section(0, towards(angle, -phi), along_x), seen, 1e-12 * mean);
      EXPECT_NEAR((seen + view.cross_section(0, direction, crossed)) / 2, sphere.amplitudes(angle).s11() / (k * k),
                  2 * scattering.error() * mean);
    }
  }
}

// At angles between its nodes, the table agrees with the series within its stated error. That error was measured midway
// between the nodes, where the error of a cubic spline is largest, within a few per cent. It is a few 1e-4 for side
// scatter: with a phase of 0.5 per node, 1.6e-4 of the fastest ripple's amplitude.
TEST(MieScattering, TableErrorIsWithinItsEstimate) {
  for (double const size : {0.05, 0.4, 1.0, 3.0, 11.0, 60.0}) {
    AngleInterval const angles{1.3, 1.9};
    MieScattering const scattering({size * micrometre}, droplets(), angles);
    MieCoefficients const sphere(size * pi / 0.532, 1.45);
    auto const view = scattering.view();
    double worst = 0, mean = 0;
    int const tried = 1000;
    for (std::uint64_t i = 0; i < tried; ++i) {
      double const angle =
          angles.least + (angles.most - angles.least) * to_unit(random_bits(3, RandomStream::pupil, 0, i));
      auto const [s1, s2] = sphere.amplitudes(angle);
      double table1 = 0, table2 = 0;
      view.intensities(0, angle, table1, table2);
      worst = std::max({worst, std::abs(table1 - std::norm(s1)), std::abs(table2 - std::norm(s2))});
      mean += (std::norm(s1) + std::norm(s2)) / 2 / tried;
    }
    // 1000 angles determine the mean to about a tenth
    EXPECT_LE(worst / mean, 1.2 * scattering.error()) << size << " um";
    EXPECT_GT(worst / mean, scattering.error() / 10) << size << " um";
    EXPECT_LT(scattering.error(), 5e-4) << size << " um";
  }
}

// Every distinct diameter has its own series, whatever their number; equal diameters share one.
TEST(MieScattering, EveryDistinctDiameterIsExact) {
  std::vector<double> diameters = many_diameters(500);
  diameters.push_back(diameters[7]);
  MieScattering const scattering(diameters, droplets(), {1.4, 1.7});
  EXPECT_EQ(scattering.tables().size(), 500u);
  auto const view = scattering.view();
  double const k = wave_number(droplets());
  for (std::size_t i = 0; i < diameters.size(); i += 20) {
    MieCoefficients const sphere(diameters[i] * k / 2, 1.45);
    double mean = 0;
    for (double const angle : {1.4, 1.5, 1.6, 1.7}) mean += sphere.amplitudes(angle).s11() / 4;
    double const exact = std::norm(sphere.amplitudes(1.53).s1) / (k * k);
    EXPECT_NEAR(view.cross_section(i, towards(1.53, pi / 2), along_x), exact, 2 * scattering.error() * mean / (k * k));
  }
  EXPECT_EQ(view.cross_section(7, towards(1.5, 1), along_x), view.cross_section(500, towards(1.5, 1), along_x));
}

// The intensity of small spheres is proportional to d^6 (Rayleigh), up to corrections of order x^2, 1e-4 here.
TEST(MieScattering, SmallParticlesShineAsTheSixthPower) {
  double const d = 0.8e-3 * micrometre;  // x = 0.005
  MieScattering const scattering({d, 2 * d, 0.5 * d}, droplets(), {1.4, 1.7});
  auto const view = scattering.view();
  double const one = view.cross_section(0, {0, 0, 1}, along_x);
  EXPECT_NEAR(view.cross_section(1, {0, 0, 1}, along_x) / one, 64, 64 * 4e-4);
  EXPECT_NEAR(one / view.cross_section(2, {0, 0, 1}, along_x), 64, 64 * 4e-4);
}

// The intensity of large spheres is proportional to d^2 if it is averaged over the ripples: over sizes within 10 %,
// angles from 46 to 57 degrees and both polarisations. These angles are reached by the rays of geometrical optics. The
// contribution of the edge is of order x^(-2/3), 0.03 at 40 um, and changes the exponent over a factor of 8 in size by
// up to 0.03/ln 8. (Refracted rays for m = 1.45 end at about 93 degrees, with a transition as wide as x^(-1/3); no size
// is large in this sense there.)
TEST(MieScattering, LargeParticlesShineAsTheSquare) {
  auto const mean = [](double diameter) {
    std::vector<double> diameters;
    for (int i = 0; i < 30; ++i) diameters.push_back(diameter * (0.95 + 0.1 * i / 29));
    MieScattering const scattering(diameters, droplets(), {0.78, 1.02});
    auto const view = scattering.view();
    double sum = 0;
    for (std::size_t i = 0; i < diameters.size(); ++i) {
      for (int j = 0; j < 200; ++j) {
        double const angle = 0.8 + 0.2 * j / 199;
        sum +=
            view.cross_section(i, towards(angle, 0), along_x) + view.cross_section(i, towards(angle, pi / 2), along_x);
      }
    }
    return sum;
  };
  EXPECT_NEAR(std::log(mean(320 * micrometre) / mean(40 * micrometre)) / std::log(8.0), 2, 0.015);
}

// A surrounding medium reduces the wavelength and the refractive index contrast: a particle vanishes in a liquid of
// equal index; otherwise it scatters like a sphere of m = n/n0 in light of wavelength lambda/n0.
TEST(MieScattering, DependsOnAmbientIndex) {
  MieSetting setting = droplets();
  setting.surroundings = 1.45;
  EXPECT_EQ(MieScattering({micrometre}, setting, {1.4, 1.7}).view().cross_section(0, {0, 0, 1}, along_x), 0);
  setting.surroundings = 1.33;
  MieSetting thin = droplets();
  thin.index = 1.45 / 1.33;
  thin.wavelength = setting.wavelength / 1.33;
  EXPECT_NEAR(MieScattering({micrometre}, setting, {1.4, 1.7}).view().cross_section(0, {0, 0, 1}, along_x) /
                  MieScattering({micrometre}, thin, {1.4, 1.7}).view().cross_section(0, {0, 0, 1}, along_x),
              1, 1e-6);  // the coefficients are floats
}

TEST(MieScattering, NoParticleAndParticlesOfNoSizeSendNothing) {
  EXPECT_EQ(MieScattering({}, droplets(), {1.4, 1.7}).tables().size(), 0u);
  MieScattering const scattering({0.0, micrometre}, droplets(), {1.4, 1.7});
  EXPECT_EQ(scattering.view().cross_section(0, {0, 0, 1}, along_x), 0);
  EXPECT_GT(scattering.view().cross_section(1, {0, 0, 1}, along_x), 0);
}

// Results are bitwise identical for any number of threads.
TEST(MieScattering, ThreadsMakeNoDifference) {
  std::vector<double> const diameters = many_diameters(300);
  set_thread_count(1);
  MieScattering const one(diameters, droplets(), {1.4, 1.7});
  set_thread_count(4);
  MieScattering const four(diameters, droplets(), {1.4, 1.7});
  set_thread_count(0);
  EXPECT_EQ(one.coefficients(), four.coefficients());
  EXPECT_EQ(one.error(), four.error());
}

// The size of the table is known beforehand and proportional to particle diameter over wavelength: 1e5 different
// droplets of about 1 um need about 10 MB for side scatter, (0.3 rad x 2 x 7/0.5 + 3) x 8 bytes each. A table that
// exceeds the memory of any machine is refused.
TEST(MieScattering, ReportsMemoryBeforeAllocation) {
  std::vector<double> const diameters = many_diameters(1000);
  AngleInterval const angles{1.4, 1.7};
  MieScattering const scattering(diameters, droplets(), angles);
  double const held = static_cast<double>(scattering.coefficients().size() * sizeof(float) +
                                          scattering.tables().size() * sizeof(MieTable) +
                                          scattering.table_of().size() * sizeof(std::uint32_t));
  EXPECT_EQ(MieScattering::bytes_needed(diameters, droplets(), angles), held);
  EXPECT_NEAR(held / 1000, (0.3 * 2 * 7 / 0.5 + 3) * 8, 60);

  std::vector<double> marbles;
  for (int i = 0; i < 100000; ++i) marbles.push_back(15e-3 + 1e-9 * i);
  EXPECT_THAT([&] { MieScattering(marbles, droplets(), {0, pi}); }, ThrowsDataError(ErrorCode::memory, "particles"));
}

}  // namespace
}  // namespace gladstone
