#include <gtest/gtest.h>
#include <time.h>

#include <algorithm>
#include <functional>

#include "analysis/correlation/correlator.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/ideal_images/ideal_images.h"
#include "render/rays/rays_renderer.h"
#include "studies/benchmark/particle_pair.h"
#include "tests/benchmarks/bench_scenes.h"
#include "tests/benchmarks/plain_loops.h"
#include "tests/support/ideal_pairs.h"

/// Speed of the paths that take most of the time of a run, relative to a plain loop that does the same work in the same
/// process. A ratio hardly depends on the speed of the machine or on its other load, unlike a time.
namespace gladstone::bench {
namespace {

/// Returns the processor time of a call by this process [s].
double processor_seconds(std::function<void()> const& call) {
  auto const now = [] {
    timespec time{};
    ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
  };
  double const start = now();
  call();
  return now() - start;
}

/// Measures how many times as fast as the plain loop the program is, on one thread: both alternate, and the smallest
/// time of each counts. Stops as soon as the ratio is sufficient.
double measure_ratio(std::function<void()> const& plain, std::function<void()> const& program, double sufficient) {
  Progress::enable(false);
  set_thread_count(1);
  double plain_seconds = 1e300, program_seconds = 1e300;
  for (int i = 0; i < 12 && (i < 3 || plain_seconds / program_seconds < sufficient); ++i) {
    plain_seconds = std::min(plain_seconds, processor_seconds(plain));
    program_seconds = std::min(program_seconds, processor_seconds(program));
  }
  set_thread_count(0);
  return plain_seconds / program_seconds;
}

/// Smallest ratios of several runs on the processor of docs/benchmarks.md while other programs used both of its cores.
/// The plain loops wait for their own results and lose less by that: on an idle machine the ratios are larger, that of
/// the rays by up to half. A path that becomes 20 % slower fails its test.
constexpr double rays_ratio = 2.2, correlation_ratio = 25, images_ratio = 25, slower = 1.2;

TEST(Speed, OfRaysThroughAVolume) {
  PlannedScene const scene = volume_scene(64, 16, 64);
  auto const& volume = std::get<SplineVolume<double>>(scene.medium.view);
  std::vector<Ray<double>> const rays = entering_rays(scene, volume);
  int const steps = static_cast<int>(std::lround(volume_width / scene.plan.step));
  double sum = 0;
  double const ratio = measure_ratio(
      [&] {
        for (Ray<double> const& ray : rays) sum += plain_steps(volume, ray, scene.plan.step, steps).position.x;
      },
      [&] {
        sum +=
            RaysRenderer().render(scene, scene.plan, scene.dots, RenderImages::yes, RenderTheory::no).light.flow(0, 0);
      },
      rays_ratio);
  EXPECT_GT(ratio, rays_ratio / slower);
  EXPECT_TRUE(std::isfinite(sum));
  RecordProperty("ratio", std::to_string(ratio));
}

TEST(Speed, OfTheCorrelationOfWindows) {
  ParticleSettings particles;
  particles.columns = particles.rows = 512;
  ParticlePair const pair = render_particle_pair(particles, [](Vec2d p) {
    return Vec2d{1.7 + std::sin(0.01 * p.y), 0.8 * std::cos(0.012 * p.x)};
  });
  CorrelationSettings settings;
  settings.window_px = {32};
  settings.overlap = 0.5;
  settings.weighting = "uniform";
  auto const correlator = make_correlator(settings);
  std::size_t vectors = 0;
  double const ratio = measure_ratio(
      [&] { vectors += static_cast<std::size_t>(plain_correlation(pair.reference, pair.flow)); },
      [&] { vectors += correlator->correlate(pair.reference, pair.flow).position_px.size(); }, correlation_ratio);
  EXPECT_GT(ratio, correlation_ratio / slower);
  RecordProperty("ratio", std::to_string(ratio));
}

TEST(Speed, OfParticleImagesByFormula) {
  auto const setup = test::pair_setup(ParticleScattering::gaussian, 512, 512);
  PlannedScene const scene(build_scene(setup));
  auto const ideal = build_ideal_images(scene);
  ASSERT_TRUE(ideal);
  std::vector<Vec2d> places;
  for (auto const& pulse : scene.particles.place) {
    for (Vec3d const place : pulse) places.push_back(ideal->project(place));
  }
  double light = 0;
  double const ratio = measure_ratio(
      [&] { light += plain_images(places, scene.spot_sigma_px(), 512, 512)(0, 0); },
      [&] {
        light +=
            render_ideal_images(*ideal, scene.particles, ParticleLight::scattered, RenderImages::yes).light.flow(0, 0);
      },
      images_ratio);
  EXPECT_GT(ratio, images_ratio / slower);
  EXPECT_TRUE(std::isfinite(light));
  RecordProperty("ratio", std::to_string(ratio));
}

}  // namespace
}  // namespace gladstone::bench
