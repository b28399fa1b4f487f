#include <benchmark/benchmark.h>

#include <cmath>
#include <map>
#include <string>

#include "analysis/correlation/correlator.h"
#include "analysis/errors/uncertainty_quality.h"
#include "analysis/uncertainty/uncertainty.h"
#include "render/base/units.h"
#include "tests/analysis/support/particle_pair.h"

namespace gladstone::bench {
namespace {

using testing::ParticlePair;
using Displacement = Vec2d (*)(Vec2d);

constexpr double middle_px = 511.5;

Vec2d uniform_30(Vec2d) { return {0.3, -0.3}; }
Vec2d uniform_60(Vec2d) { return {0.6, -0.6}; }
Vec2d shear(Vec2d p) { return {0.02 * (p.y - middle_px), 0.0}; }
/// Lamb & Oseen's, at most 5 px at 112 px from its middle.
Vec2d vortex(Vec2d p) {
  constexpr double radius_px = 100.0, most_px = 5.0, a = 1.2564312086261697;
  double const strength = most_px * std::sqrt(a) * radius_px / (1.0 - std::exp(-a));
  Vec2d const r{p.x - middle_px, p.y - middle_px};
  double const square = std::max(dot(r, r), 1e-12);
  double const f = -strength * std::expm1(-square / (radius_px * radius_px)) / square;
  return {-f * r.y, f * r.x};
}
template <int length_px>
Vec2d sine(Vec2d p) {
  return {std::sin(2.0 * pi * p.y / length_px), std::sin(2.0 * pi * p.x / length_px)};
}

class BenchFrames final : public FramePair {
 public:
  explicit BenchFrames(ParticlePair const& pair) : pair_(pair) {}
  Image<double> const& reference() const override { return pair_.reference; }
  Image<double> const& flow() const override { return pair_.flow; }

 private:
  ParticlePair const& pair_;
};

/// Errors of vectors at least 32 px from the border: per component rms and bias, share of the displacement that they
/// follow, those above 1 px, and how well sigma tells them.
void report_errors(benchmark::State& state, DisplacementField const& field, Displacement truth) {
  double squares = 0.0, bias = 0.0, product = 0.0, signal = 0.0, count = 0.0, gross = 0.0;
  std::vector<Vec2d> right;
  VectorMask inside;
  for (std::size_t i = 0; i < field.size(); ++i) {
    Vec2d const at = field.position_px[i], t = truth(at);
    right.push_back(t);
    inside.push_back(std::min(at.x, at.y) >= 32.0 && std::max(at.x, at.y) <= 991.0 && field.counts(i));
    if (!inside.back()) continue;
    Vec2d const error = field.displacement_px[i] - t;
    count += 1.0;
    bias += error.x;
    squares += dot(error, error);
    if (length(error) > gross_error_px) {
      gross += 1.0;
      continue;
    }
    product += dot(field.displacement_px[i], t);
    signal += dot(t, t);
  }
  state.counters["rms_mpx"] = 1e3 * std::sqrt(squares / (2.0 * count));
  state.counters["bias_mpx"] = 1e3 * bias / count;
  state.counters["gain"] = product / signal;
  state.counters["gross"] = gross;
  if (field.sigma_px.empty()) return;
  UncertaintyQuality const quality = uncertainty_quality(field.displacement_px, right, field.sigma_px, inside);
  for (auto const& [name, value] : quality_measures(quality)) state.counters[std::string(name)] = value;
}

void measure(benchmark::State& state, CorrelationSettings const& settings, Displacement truth, double noise,
             std::uint64_t seed) {
  ParticlePair const pair =
      testing::render_particle_pair({.columns = 1024, .rows = 1024, .noise = noise, .seed = seed}, truth);
  DisplacementField field;
  for (auto _ : state) {
    field = make_correlator(settings)->correlate(pair.reference, pair.flow);
    estimate_uncertainty(field, BenchFrames(pair), settings);
  }
  report_errors(state, field, truth);
}

/// One benchmark for each method and case of docs/estimators.md.
int register_all() {
  struct Case {
    char const* name;
    Displacement truth;
    double noise;
  };
  static constexpr Case cases[] = {{"uniform_0.3", uniform_30, 0.0},
                                   {"uniform_0.6", uniform_60, 0.0},
                                   {"uniform_0.3/noise_5", uniform_30, 0.05},
                                   {"vortex", vortex, 0.0},
                                   {"shear", shear, 0.0},
                                   {"sine_128", sine<128>, 0.0},
                                   {"sine_64", sine<64>, 0.0},
                                   {"sine_32", sine<32>, 0.0}};
  auto const add = [](std::string const& name, CorrelationSettings const& settings, Case const& one,
                      std::uint64_t seed) {
    auto const run = [settings, one, seed](benchmark::State& state) {
      measure(state, settings, one.truth, one.noise, seed);
    };
    benchmark::RegisterBenchmark(("estimator/" + name + '/' + one.name).c_str(), run)
        ->Iterations(1)
        ->UseRealTime()
        ->Unit(benchmark::kMillisecond);
  };
  for (Case const& one : cases) {
    for (std::string const& method : correlation_methods())
      for (char const* const fit : {"gauss3", "gauss2d"}) {
        CorrelationSettings settings;
        settings.window_px = {32};
        settings.overlap = 0.5;
        settings.method = method;
        settings.subpixel = fit;
        add("one_pass_" + method + '_' + fit, settings, one, 1);
      }
    add("default", {}, one, 1);
  }
  for (double const noise : {0.01, 0.05, 0.1})
    for (Case one : {cases[0], cases[3], cases[4]})
      for (std::string const& method : uncertainty_methods()) {
        CorrelationSettings settings;
        settings.uncertainty = method;
        one.noise = noise;
        for (std::uint64_t const seed : {201, 202, 203, 204})
          add(method + "/noise_" + std::to_string(static_cast<int>(100.0 * noise)) + "/seed_" + std::to_string(seed),
              settings, one, seed);
      }
  return 0;
}

[[maybe_unused]] int const registered = register_all();

}  // namespace
}  // namespace gladstone::bench
