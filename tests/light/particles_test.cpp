#include "render/light/particles.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>

#include "render/base/parallel.h"
#include "render/light/lambert_sphere.h"
#include "tests/light/particle_cube.h"
#include "tests/support/expect_error.h"

namespace gladstone {
namespace {

constexpr double mm = 1e-3, um = 1e-6;

std::string csv(std::string const& name, std::string const& text) {
  std::string const path = testing::TempDir() + "/particles_" + name;
  std::ofstream(path) << text;
  return path;
}

// At both pulses, the volume contains the requested number of particles: 20000 up to the square root of that number
// (the number that moves in is random), within four standard deviations. The particles move by u dt.
TEST(SeededParticles, FillTheVolumeAtBothPulses) {
  FlowSetup const flow = uniform_flow({100, -30, 60});
  Particles const particles = seed_particles(cube_of_particles(10 * mm), 20000, flow, wide_sheet(), 1e-12);
  for (int pulse = 0; pulse < 2; ++pulse) {
    auto const& lit = particles.photons[pulse];
    EXPECT_NEAR(static_cast<double>(std::count_if(lit.begin(), lit.end(), [](double p) { return p > 0; })), 20000,
                4 * std::sqrt(20000.0));
  }
  for (std::size_t i = 0; i < particles.size(); ++i) {
    EXPECT_LT(length(particles.place[1][i] - particles.place[0][i] - Vec3d{1e-3, -0.3e-3, 0.6e-3}), 1e-15);
  }
}

// A particle is illuminated if and only if it is in the volume.
TEST(SeededParticles, AreDarkOutsideTheVolume) {
  Particles const particles =
      seed_particles(cube_of_particles(10 * mm), 5000, uniform_flow({0, 0, 100}), wide_sheet(), 1e-12);
  std::size_t dark = 0;
  for (int pulse = 0; pulse < 2; ++pulse) {
    for (std::size_t i = 0; i < particles.size(); ++i) {
      Vec3d const p = particles.place[pulse][i];
      bool const inside = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) <= 5 * mm;
      EXPECT_EQ(particles.photons[pulse][i] > 0, inside);
      dark += inside ? 0 : 1;
    }
  }
  // a tenth of the volume moves out, and as much moves in
  EXPECT_NEAR(static_cast<double>(dark), 1000, 4 * std::sqrt(1000.0));
}

// At mid-time, a particle is at its seeded position for any dt.
TEST(SeededParticles, AreAtSeededPositionsAtMidTime) {
  FlowSetup vortex = uniform_flow({});
  vortex.flow.kind = RotationFlow{2e4, {}};
  ParticleSetup const setup = cube_of_particles(4 * mm);
  Particles const turned = seed_particles(setup, 100, vortex, wide_sheet(), 1e-12);
  // solid-body rotation by +-0.1: the midpoint of both ends is at cos(0.1) times the radius, which is constant
  for (std::size_t i = 0; i < turned.size(); ++i) {
    Vec3d const a = turned.place[0][i], b = turned.place[1][i], middle = 0.5 * (a + b);
    double const radius = std::hypot(a.x, a.y);
    EXPECT_NEAR(std::hypot(b.x, b.y), radius, 1e-11);
    EXPECT_NEAR(std::hypot(middle.x, middle.y), std::cos(0.1) * radius, 1e-11);
    double const angle = std::atan2(a.x * b.y - a.y * b.x, a.x * b.x + a.y * b.y);
    EXPECT_NEAR(angle, 0.2, 1e-8);
  }
  EXPECT_LE(turned.path.error, 1e-12);
}

// Behind a normal shock at Mach 2, the density of the gas, and of particles that follow it, is 8/3 of that in front. Of
// a volume that the front divides into halves, 3 of 11 particles are in front of it at either pulse, of 20000 in all.
// Tolerance: four standard deviations.
TEST(SeededParticles, AreDenserBehindShock) {
  FlowSetup flow;
  flow.dt = 2e-6;
  NormalShockFlow shock;
  shock.upstream = 680;
  shock.downstream = 255;
  flow.flow.kind = shock;
  Particles const particles = seed_particles(cube_of_particles(10 * mm), 20000, flow, wide_sheet(), 1e-12);
  for (int pulse = 0; pulse < 2; ++pulse) {
    double before = 0, all = 0;
    for (std::size_t i = 0; i < particles.size(); ++i) {
      if (!(particles.photons[pulse][i] > 0)) continue;
      all += 1;
      before += particles.place[pulse][i].x < 0 ? 1 : 0;
    }
    EXPECT_NEAR(all, 20000, 4 * std::sqrt(20000.0));
    EXPECT_NEAR(before / all, 3.0 / 11, 4 * std::sqrt(3.0 / 11 * 8 / 11 / 20000));
  }
  EXPECT_EQ(particles.path.error, 0);
}

TEST(SeededParticles, AreTheSameForAnyNumberOfThreads) {
  FlowSetup const flow = uniform_flow({100, -30, 60});
  ParticleSetup setup = cube_of_particles(10 * mm);
  setup.diameter = {DiameterSpread::lognormal, um, 0.3, ""};
  int const before = thread_count();
  set_thread_count(1);
  Particles const one = seed_particles(setup, 20000, flow, wide_sheet(), 1e-12);
  set_thread_count(3);
  Particles const many = seed_particles(setup, 20000, flow, wide_sheet(), 1e-12);
  set_thread_count(before);
  EXPECT_EQ(one.place[0], many.place[0]);
  EXPECT_EQ(one.place[1], many.place[1]);
  EXPECT_EQ(one.diameter, many.diameter);
  EXPECT_EQ(one.photons[1], many.photons[1]);
}

// The mean and the standard deviation of N draws have standard errors of sigma / sqrt(N) and sigma / sqrt(2 N).
// Tolerance: four standard errors.
TEST(Diameters, AreDrawnFromTheirDistribution) {
  constexpr std::size_t n = 40000;
  auto const moments = [](std::vector<double> const& values) {
    double const mean = std::accumulate(values.begin(), values.end(), 0.0) / n;
    double square = 0;
    for (double const v : values) square += (v - mean) * (v - mean) / n;
    return std::pair{mean, std::sqrt(square)};
  };
  std::vector<double> logs = draw_diameters({DiameterSpread::lognormal, 2 * um, 0.4, ""}, 5, n);
  for (double& d : logs) d = std::log(d);
  auto const [log_mean, log_deviation] = moments(logs);
  EXPECT_NEAR(log_mean, std::log(2 * um), 4 * 0.4 / std::sqrt(n));
  EXPECT_NEAR(log_deviation, 0.4, 4 * 0.4 / std::sqrt(2 * n));
  auto const [mean, deviation] = moments(draw_diameters({DiameterSpread::normal, 2 * um, 0.3 * um, ""}, 5, n));
  EXPECT_NEAR(mean, 2 * um, 4 * 0.3 * um / std::sqrt(n));
  EXPECT_NEAR(deviation, 0.3 * um, 4 * 0.3 * um / std::sqrt(2 * n));
  std::string const table = csv("sizes.csv", "diameter_um,weight\n1,3\n2.5,1\n");
  std::vector<double> const drawn = draw_diameters({DiameterSpread::table, um, 0, table}, 5, n);
  auto const small = std::count(drawn.begin(), drawn.end(), 1 * um);
  EXPECT_NEAR(static_cast<double>(small), 0.75 * n, 4 * std::sqrt(0.75 * 0.25 * n));
  EXPECT_EQ(small + std::count(drawn.begin(), drawn.end(), 2.5 * um), static_cast<std::ptrdiff_t>(n));
}

TEST(ParticleFile, HoldsThePlacesOfTheFirstPulse) {
  ParticleSetup setup;
  setup.count = ParticleCount::file;
  setup.file = csv("good.csv", "x_mm,y_mm,z_mm,diameter_um\n1,2,-0.5,1.5\n-3e1,0,0,2\n");
  Particles const particles = read_particles(setup, uniform_flow({100, 0, 0}), wide_sheet(), 1e-12);
  ASSERT_EQ(particles.size(), 2u);
  EXPECT_EQ(particles.place[0][0], (Vec3d{1 * mm, 2 * mm, -0.5 * mm}));
  EXPECT_NEAR(particles.place[1][0].x, 2 * mm, 1e-17);
  EXPECT_DOUBLE_EQ(particles.diameter[1], 2 * um);
  EXPECT_GT(particles.photons[0][1], 0);
}

TEST(ParticleFile, IsRefusedWithThePlaceOfItsMistake) {
  auto const reading = [](std::string const& text) {
    return [path = csv("bad.csv", text)] {
      ParticleSetup setup;
      setup.file = path;
      read_particles(setup, uniform_flow({}), wide_sheet(), 1e-12);
    };
  };
  std::string const header = "x_mm,y_mm,z_mm,diameter_um\n";
  EXPECT_THAT(reading("x,y,z\n"), ThrowsDataError(ErrorCode::wrong_format, "bad.csv:1"));
  EXPECT_THAT(reading(header + "1,2,3\n"), ThrowsDataError(ErrorCode::syntax, "bad.csv:2"));
  EXPECT_THAT(reading(header + "1,2,3,1\n0,0,0,0\n"), ThrowsDataError(ErrorCode::out_of_range, "bad.csv:3"));
  EXPECT_THAT(reading(header + "1,2,nan,1\n"), ThrowsDataError(ErrorCode::syntax, "bad.csv:2"));
  EXPECT_THAT(reading(header), ThrowsDataError(ErrorCode::missing_content, "bad.csv"));
}

// White spheres scatter all the light that falls on them: the integral over all directions is pi d^2 / 4. The error of
// the midpoint rule is (pi / 20000)^2 / 24 times the second derivative.
TEST(LambertSpheres, ScatterAllIncidentLight) {
  double const d = 3 * um;
  LambertSpheres<double> const spheres{&d};
  LightWave<double> const wave;
  double sum = 0;
  constexpr int points = 20000;
  for (int k = 0; k < points; ++k) {
    double const t = (k + 0.5) * pi / points;
    sum += spheres.cross_section(0, {std::cos(t), 0, std::sin(t)}, wave) * 2 * pi * std::sin(t) * pi / points;
  }
  EXPECT_NEAR(sum, pi * d * d / 4, 1e-7 * d * d);
  EXPECT_EQ(spheres.cross_section(0, {1, 0, 0}, wave), 0);
  // seen from the laser: geometric albedo of 2/3
  EXPECT_NEAR(spheres.cross_section(0, {-1, 0, 0}, wave), d * d / 6, 1e-12 * d * d);
}

}  // namespace
}  // namespace gladstone
