#include "render/light/particle_sequence.h"

#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "render/base/parallel.h"
#include "tests/light/particle_cube.h"

namespace gladstone {
namespace {

constexpr double one_mm = 1e-3;

/// Particles listed in a file, without a volume.
ParticleSetup listed_particles(std::vector<Vec3d> const& places) {
  std::string const path = testing::TempDir() + "/particle_sequence.csv";
  std::ofstream file(path);
  file.precision(17);
  file << "x_mm,y_mm,z_mm,diameter_um\n";
  for (Vec3d const& p : places) file << p.x / one_mm << ',' << p.y / one_mm << ',' << p.z / one_mm << ",1\n";
  ParticleSetup setup;
  setup.count = ParticleCount::file;
  setup.file = path;
  return setup;
}

/// Returns the particles in the light at one of both frames, in their order.
std::vector<Vec3d> lit_places(Particles const& particles, int frame) {
  std::vector<Vec3d> places;
  for (std::size_t i = 0; i < particles.size(); ++i)
    if (particles.photons[frame][i] > 0) places.push_back(particles.place[frame][i]);
  return places;
}

std::vector<Vec3d> const three_places{
    {1 * one_mm, 2 * one_mm, 0.5 * one_mm}, {-3 * one_mm, 0.25 * one_mm, -1 * one_mm}, {0, -4 * one_mm, 0}};

// In a uniform flow, particles are at p + k u dt in frame k.
TEST(ParticleSequence, ShiftsParticlesByTheUniformFlow) {
  Vec3d const step{0.141 * one_mm, -0.03 * one_mm, 0.02 * one_mm};
  ParticleSequence sequence(listed_particles(three_places), 0, uniform_flow(step / 1e-5), wide_sheet(), 1e-12);
  for (std::size_t k : {0u, 1u, 7u}) {
    Particles const pair = sequence.pair(k);
    ASSERT_EQ(pair.size(), three_places.size());
    for (std::size_t i = 0; i < pair.size(); ++i) {
      EXPECT_LT(length(pair.place[0][i] - three_places[i] - static_cast<double>(k) * step), 1e-15) << k;
      EXPECT_LT(length(pair.place[1][i] - three_places[i] - static_cast<double>(k + 1) * step), 1e-15) << k;
    }
  }
}

// In solid-body rotation, particles keep their radius and turn by k omega dt: 20 frames of 0.05 rad. The step is chosen
// for an error of 1e-12 m per frame.
TEST(ParticleSequence, TurnsParticlesByTheSolidRotation) {
  FlowSetup flow = uniform_flow({});
  flow.flow.kind = RotationFlow{5000, {}};
  ParticleSequence sequence(listed_particles(three_places), 0, flow, wide_sheet(), 1e-12);
  Particles const pair = sequence.pair(20);
  for (std::size_t i = 0; i < pair.size(); ++i) {
    for (int frame = 0; frame < 2; ++frame) {
      double const angle = 0.05 * (20 + frame);
      Vec3d const p = three_places[i];
      Vec3d const turned{std::cos(angle) * p.x - std::sin(angle) * p.y, std::sin(angle) * p.x + std::cos(angle) * p.y,
                         p.z};
      EXPECT_LT(length(pair.place[frame][i] - turned), 21e-12);
    }
  }
}

// The second frame of a pair is the first one of the next: the same particles at the same places, bit by bit.
TEST(ParticleSequence, SharesFramesBetweenPairs) {
  ParticleSetup setup = cube_of_particles(4 * one_mm);
  setup.diameter.spread = DiameterSpread::lognormal;
  setup.diameter.width = 0.3;
  ParticleSequence sequence(setup, 500, uniform_flow({60, 20, -30}), wide_sheet(), 1e-12);
  Particles before = sequence.pair(0);
  for (std::size_t k = 1; k < 4; ++k) {
    Particles const next = sequence.pair(k);
    EXPECT_EQ(lit_places(before, 1), lit_places(next, 0)) << k;
    std::vector<double> diameters[2];
    for (std::size_t i = 0; i < before.size(); ++i)
      if (before.photons[1][i] > 0) diameters[0].push_back(before.diameter[i]);
    for (std::size_t i = 0; i < next.size(); ++i)
      if (next.photons[0][i] > 0) diameters[1].push_back(next.diameter[i]);
    EXPECT_EQ(diameters[0], diameters[1]) << k;
    before = next;
  }
}

// A quarter of the volume is replaced in each of 12 frames. In every frame it contains the requested number of
// particles, in each half and in total, to within five standard deviations of a Poisson distribution.
TEST(ParticleSequence, KeepsTheNumberDensity) {
  constexpr double count = 10000;
  ParticleSequence sequence(cube_of_particles(10 * one_mm), count, uniform_flow({200, 50, 0}), wide_sheet(), 1e-12);
  for (std::size_t k = 0; k < 12; ++k) {
    std::vector<Vec3d> const places = lit_places(sequence.pair(k), 0);
    EXPECT_NEAR(static_cast<double>(places.size()), count, 5 * std::sqrt(count)) << k;
    for (int axis = 0; axis < 3; ++axis) {
      auto const half = std::count_if(places.begin(), places.end(), [axis](Vec3d p) { return p[axis] > 0; });
      EXPECT_NEAR(static_cast<double>(half), count / 2, 5 * std::sqrt(count / 2)) << k << ' ' << axis;
    }
  }
}

// A vortex whose axis is in a corner of the volume moves particles in and out along curved paths.
TEST(ParticleSequence, KeepsTheNumberDensityInAVortex) {
  constexpr double count = 4000;
  FlowSetup flow = uniform_flow({});
  flow.flow.kind = RotationFlow{1e4, {4 * one_mm, 4 * one_mm, 0}};
  ParticleSequence sequence(cube_of_particles(8 * one_mm), count, flow, wide_sheet(), 1e-9);
  EXPECT_NEAR(static_cast<double>(lit_places(sequence.pair(15), 0).size()), count, 5 * std::sqrt(count));
}

// Pairs do not depend on the order of the calls or on the number of threads.
TEST(ParticleSequence, DependsOnTheSeedOnly) {
  ParticleSetup setup = cube_of_particles(4 * one_mm);
  auto const make = [&] { return ParticleSequence(setup, 300, uniform_flow({60, 20, -30}), wide_sheet(), 1e-12); };
  int const threads = thread_count();
  ParticleSequence first = make();
  Particles const expected = first.pair(5);
  EXPECT_NE(first.pair(2).place[0], expected.place[0]);
  EXPECT_EQ(first.pair(5).place[1], expected.place[1]);
  set_thread_count(1);
  EXPECT_EQ(make().pair(5).place[0], expected.place[0]);
  set_thread_count(threads);
  setup.seed = 2;
  EXPECT_NE(make().pair(5).place[0], expected.place[0]);
}

// Particles that enter after a step were outside the volume before it, and are dark there.
TEST(ParticleSequence, AddsParticlesFromOutside) {
  ParticleSequence sequence(cube_of_particles(10 * one_mm), 2000, uniform_flow({100, 0, 0}), wide_sheet(), 1e-12);
  Particles const pair = sequence.pair(3);
  std::size_t entered = 0;
  for (std::size_t i = 0; i < pair.size(); ++i) {
    if (pair.photons[0][i] > 0) continue;
    EXPECT_LT(pair.place[0][i].x, -5 * one_mm);
    ++entered;
  }
  EXPECT_NEAR(static_cast<double>(entered), 200, 5 * std::sqrt(200.0));  // a tenth of the volume per frame
}

}  // namespace
}  // namespace gladstone
