#include <benchmark/benchmark.h>

#include <string>

#include "analysis/correlation/correlation_methods.h"
#include "analysis/correlation/correlator.h"
#include "analysis/tracking/tracking_correlator.h"
#include "analysis/uncertainty/uncertainty.h"
#include "studies/benchmark/benchmark_run.h"

namespace gladstone::bench {
namespace {

/// Reports the errors of vectors at least 32 px from the border: rms and bias per component, the gain (fraction of the
/// displacement that the vectors follow), the number of errors above 1 px, and the coverage of sigma.
void report_errors(benchmark::State& state, DisplacementField const& field, BenchmarkCase const& one) {
  int const columns = one.particles.columns, rows = one.particles.rows;
  std::vector<Vec2d> const truth = truth_at_vectors(field, one.flow);
  BenchmarkScore const score = score_vectors(field, truth, columns, rows);
  state.counters["rms_mpx"] = 1e3 * score.errors["rms_px"];
  state.counters["bias_mpx"] = 1e3 * score.errors["bias_u_px"];
  state.counters["gain"] = score.gain;
  state.counters["gross"] = score.errors["gross"];
  if (field.sigma_px.empty()) return;
  UncertaintyQuality const quality =
      uncertainty_quality(field.displacement_px, truth, field.sigma_px, benchmark_mask(field, columns, rows));
  for (auto const& [name, value] : quality_measures(quality)) state.counters[std::string(name)] = value;
}

void measure(benchmark::State& state, CorrelationSettings const& settings, BenchmarkCase const& one) {
  ParticlePair pair = render_particle_pair(one.particles, one.flow);
  HostFrames const frames(std::move(pair.reference), std::move(pair.flow));
  DisplacementField field;
  for (auto _ : state) {
    field = tracking::make_cpu_correlator(settings)->correlate_pair(frames);
    estimate_uncertainty(field, frames, settings);
  }
  report_errors(state, field, one);
}

/// One benchmark for each estimator and case of `gladstone benchmark` that is drawn by formula, and for each
/// uncertainty method at three levels of noise and four seeds.
int register_all() {
  auto const add = [](std::string const& name, CorrelationSettings const& settings, BenchmarkCase const& one) {
    benchmark::RegisterBenchmark(("estimator/" + name).c_str(),
                                 [settings, one](benchmark::State& state) { measure(state, settings, one); })
        ->Iterations(1)
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
  };
  for (BenchmarkCase const& one : benchmark_cases()) {
    if (one.refracted()) continue;
    for (BenchmarkEstimator const& estimator : benchmark_estimators())
      add(estimator.name + '/' + one.name, estimator.settings, one);
    CorrelationSettings tracked;
    tracked.method = "tracking";
    for (char const* output : {"grid", "scattered"}) {
      tracked.tracking.output = output;
      add(std::string("tracking_") + output + '/' + one.name, tracked, one);
    }
    for (CorrelationMethod const& method : all_correlation_methods()) {
      if (method.tracks_dots) continue;
      CorrelationSettings settings;
      settings.window_px = {32};
      settings.overlap = 0.5;
      settings.method = method.name;
      add(std::string("one_pass_") + method.name + '/' + one.name, settings, one);
    }
  }
  for (int const percent : {1, 5, 10})
    for (BenchmarkCase one : benchmark_cases()) {
      if (one.name != "uniform" && one.name != "shear" && one.name != "vortex") continue;
      for (std::string const& method : uncertainty_methods())
        for (std::uint64_t const seed : {201, 202, 203, 204}) {
          CorrelationSettings settings;
          settings.uncertainty = method;
          one.particles.noise = 0.01 * percent;
          one.particles.seed = seed;
          add(method + '/' + one.name + "/noise_" + std::to_string(percent) + "/seed_" + std::to_string(seed), settings,
              one);
        }
    }
  return 0;
}

[[maybe_unused]] int const registered = register_all();

}  // namespace
}  // namespace gladstone::bench
