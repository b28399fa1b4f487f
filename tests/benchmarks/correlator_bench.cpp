#include <benchmark/benchmark.h>

#include "analysis/correlation/correlator.h"
#include "render/base/parallel.h"
#include "studies/benchmark/particle_pair.h"

namespace gladstone::bench {
namespace {

/// Measures vectors per second for a pair of 1024 x 1024 px with 20 particles per window of 32 px and a smooth
/// displacement.
void correlate(benchmark::State& state, CorrelationSettings const& settings) {
  static ParticlePair const pair = [] {
    ParticleSettings particles;
    particles.columns = particles.rows = 1024;
    return render_particle_pair(particles, [](Vec2d p) {
      return Vec2d{1.7 + std::sin(0.01 * p.y), 0.8 * std::cos(0.012 * p.x)};
    });
  }();
  set_thread_count(static_cast<int>(state.range(0)));
  auto const correlator = make_correlator(settings);
  std::size_t vectors = 0;
  for (auto _ : state) vectors = correlator->correlate(pair.reference, pair.flow).position_px.size();
  set_thread_count(0);
  state.counters["vectors"] = static_cast<double>(vectors);
  state.counters["vectors/s"] =
      benchmark::Counter(static_cast<double>(vectors), benchmark::Counter::kIsIterationInvariantRate);
}

void correlate_single_pass(benchmark::State& state, char const* method, char const* weighting) {
  CorrelationSettings settings;
  settings.window_px = {32};
  settings.overlap = 0.5;
  settings.method = method;
  settings.weighting = weighting;
  correlate(state, settings);
}
void on_one_and_two_threads(benchmark::internal::Benchmark* bench) {
  bench->ArgName("threads")->Arg(1)->Arg(2)->UseRealTime()->MinTime(1.0)->Unit(benchmark::kMillisecond);
}
BENCHMARK_CAPTURE(correlate_single_pass, scc_uniform, "scc", "uniform")->Apply(on_one_and_two_threads);
BENCHMARK_CAPTURE(correlate_single_pass, scc, "scc", "gaussian")->Apply(on_one_and_two_threads);
BENCHMARK_CAPTURE(correlate_single_pass, rpc, "rpc", "gaussian")->Apply(on_one_and_two_threads);
BENCHMARK_CAPTURE(correlate_single_pass, opencv, "opencv", "gaussian")->Apply(on_one_and_two_threads);

void correlate_multi_pass(benchmark::State& state) { correlate(state, CorrelationSettings{}); }
BENCHMARK(correlate_multi_pass)->Apply(on_one_and_two_threads);

}  // namespace
}  // namespace gladstone::bench
