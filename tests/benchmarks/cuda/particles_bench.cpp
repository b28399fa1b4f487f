#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <vector>

#include "cuda/backend.h"
#include "render/base/progress.h"
#include "render/rays/ray_planning.h"
#include "tests/benchmarks/bench_scenes.h"

namespace gladstone::bench {
namespace {

/// Returns the setup of droplets of about 1 um, all of different diameters, in a laser sheet 750 mm in front of the
/// lens at f/11; 1024 x 1024 px of 6.5 um, whose view is 41 mm wide.
Setup droplets_setup(Setup setup, double sheet) {
  setup.camera.columns = setup.camera.rows = 1024;
  setup.camera.pixel_pitch = 6.5e-6;
  setup.z_d = 0;
  setup.medium.field = {};
  PivSetup piv;
  piv.laser.thickness = sheet;
  piv.laser.height = 60e-3;
  piv.particles.volume = Vec3d{42e-3, 42e-3, sheet};
  piv.particles.diameter.spread = DiameterSpread::lognormal;
  piv.particles.diameter.width = 0.2;
  piv.flow.flow.uniform = {50, 20, 10};
  setup.piv = piv;
  return setup;
}

/// @param rays of a particle; 0: what accuracy takes
PlannedScene droplets_scene(Setup const& setup, std::uint64_t rays) {
  PlannedScene scene(build_scene(setup));
  plan_step(scene);
  if (rays == 0) scene.plan = plan_rays_by_tracing(scene, scene.plan);
  if (rays > 0) scene.plan.rays = rays;
  return scene;
}

/// Renders a pair again and again, and says how many rays particles take. @return the median time [s]
double seconds_a_pair(benchmark::State& state, PlannedScene const& scene, RenderImages images) {
  auto const renderer = cuda::make_rays_renderer();
  Rendering const first =
      renderer->render_particles(scene, scene.plan, scene.particles, ParticleLight::scattered, images);
  std::vector<std::int64_t> const& rays = first.truth.rays_planned;
  state.counters["rays"] = static_cast<double>(first.rays) / static_cast<double>(frame_count * rays.size());
  state.counters["most_rays"] = static_cast<double>(*std::max_element(rays.begin(), rays.end()));
  std::vector<double> seconds;
  for (auto _ : state) {
    auto const start = std::chrono::steady_clock::now();
    Rendering const rendering =
        renderer->render_particles(scene, scene.plan, scene.particles, ParticleLight::scattered, images);
    benchmark::DoNotOptimize(rendering.truth.displacement_px.data());
    seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    state.SetIterationTime(seconds.back());
  }
  auto const middle = seconds.begin() + static_cast<std::ptrdiff_t>(seconds.size() / 2);
  std::nth_element(seconds.begin(), middle, seconds.end());
  return *middle;
}

bool has_device(benchmark::State& state) {
  Progress::enable(false);
  cuda::DeviceState const device = cuda::device_state();
  if (!device.usable) state.SkipWithError(device.text.c_str());
  return device.usable;
}

/// Renders a tomographic case: 1e5 droplets in a volume 10 mm deep, seen through the double Gauss, with Mie scattering.
/// Rays are counted in each frame.
void particles_tomographic(benchmark::State& state) {
  if (!has_device(state)) return;
  Setup setup = droplets_setup(double_gauss_setup(), 10e-3);
  setup.piv->laser.profile = SheetProfile::top_hat;
  setup.piv->particles.amount = 100000;
  PlannedScene scene = droplets_scene(setup, static_cast<std::uint64_t>(state.range(0)));
  double const seconds = seconds_a_pair(state, scene, RenderImages::in_place);
  state.counters["ms_a_frame"] = 1e3 * seconds / frame_count;
  state.counters["Grays/s"] =
      1e-9 * frame_count * static_cast<double>(scene.particles.size()) * state.counters["rays"].value / seconds;
}
BENCHMARK(particles_tomographic)
    ->ArgName("rays")
    ->Arg(10000)
    ->Arg(0)
    ->UseManualTime()
    ->Iterations(3)
    ->Unit(benchmark::kMillisecond);

/// Renders pairs of 1 Mpx with 0.05 particles per pixel in a sheet of 1 mm through an ideal lens, with as many rays as
/// the accuracy requires.
void particle_pairs(benchmark::State& state, ParticleScattering scattering, RenderImages images) {
  if (!has_device(state)) return;
  Setup setup = droplets_setup({}, 1e-3);
  setup.piv->particles.count = ParticleCount::per_pixel;
  setup.piv->particles.amount = 0.05;
  setup.piv->particles.scattering = scattering;
  PlannedScene scene = droplets_scene(setup, 0);
  state.counters["pairs/s"] = 1 / seconds_a_pair(state, scene, images);
  state.counters["particles"] = static_cast<double>(scene.particles.size());
}

void particle_pairs_lambert(benchmark::State& state) {
  particle_pairs(state, ParticleScattering::lambert, RenderImages::in_place);
}
BENCHMARK(particle_pairs_lambert)->UseManualTime()->Iterations(50)->Unit(benchmark::kMillisecond);

void particle_pairs_lambert_to_host(benchmark::State& state) {
  particle_pairs(state, ParticleScattering::lambert, RenderImages::yes);
}
BENCHMARK(particle_pairs_lambert_to_host)->UseManualTime()->Iterations(50)->Unit(benchmark::kMillisecond);

void particle_pairs_mie(benchmark::State& state) {
  particle_pairs(state, ParticleScattering::mie, RenderImages::in_place);
}
BENCHMARK(particle_pairs_mie)->UseManualTime()->Iterations(50)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace gladstone::bench
