#include "studies/benchmark/benchmark_coverage.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <tuple>

#include "analysis/uncertainty/uncertainty.h"
#include "studies/compare/correlate.h"

namespace gladstone::inline benchmarks {
namespace {

constexpr int coverage_pixels = RefractedTurbulence::pixels;
constexpr double noises[] = {0.01, 0.05, 0.1};
/// First of the seeds that are reserved for the coverage.
constexpr std::uint64_t first_coverage_seed = 7001;

struct TestedFlow {
  char const* name;
  DisplacementAt displacement;  ///< displacement of the case; empty: refracted turbulence
};

/// Coverages and ratios for one seed.
struct Sample {
  double window, deformed_window, total, rms_ratio, rms_ratio_deformed_window, rms_ratio_total;
};

SeedMean mean_of(std::vector<Sample> const& samples, double Sample::*value) {
  double sum = 0.0, squares = 0.0;
  double const n = static_cast<double>(samples.size());
  for (Sample const& sample : samples) sum += sample.*value;
  double const mean = sum / n;
  for (Sample const& sample : samples) squares += (sample.*value - mean) * (sample.*value - mean);
  return {mean, std::sqrt(squares / (n - 1.0) / n)};  // NaN for a single seed
}

constexpr int learning_pixels = 512;
/// First of the seeds that are reserved for the training set.
constexpr std::uint64_t first_learning_seed = 9001;

struct Seeding {
  double diameter_px, per_window;
};

}  // namespace

std::vector<CoverageRow> measure_coverage(int seeds, Backend const& device) {
  TestedFlow const flows[] = {{"uniform", uniform_flow({0.3, -0.3})},
                              {"shear", shear_flow(0.02, coverage_pixels)},
                              {"vortex", vortex_flow(100.0, coverage_pixels)},
                              {"turbulence", {}}};
  std::map<std::tuple<std::string, std::string, double>, std::vector<Sample>> samples;
  for (TestedFlow const& flow : flows) {
    DisplacementAt truth = flow.displacement;
    for (int k = 0; k < seeds; ++k) {
      std::uint64_t const seed = first_coverage_seed + static_cast<std::uint64_t>(k);
      spdlog::info("coverage: {}, seed {} of {}", flow.name, k + 1, seeds);
      std::optional<RefractedTurbulence> turbulence;
      if (!flow.displacement) {
        turbulence.emplace(seed, *device.renderer);
        if (!truth) truth = turbulence->truth();
      }
      for (double const noise : noises) {
        ParticlePair pair =
            turbulence
                ? turbulence->frames(noise, seed)
                : render_particle_pair(
                      {.columns = coverage_pixels, .rows = coverage_pixels, .noise = noise, .seed = seed}, truth);
        CorrelationSettings settings;
        HostFrames const frames(std::move(pair.reference), std::move(pair.flow));
        DisplacementField field = correlate_frames(frames, settings, device).field;
        std::vector<Vec2d> const point = truth_at_vectors(field, truth);
        WindowTruths const on = compute_window_truths(field, pair, settings, coverage_pixels, coverage_pixels);
        VectorMask mask = benchmark_mask(field, coverage_pixels, coverage_pixels);
        for (std::size_t i = 0; i < mask.size(); ++i) mask[i] = mask[i] && field.status[i] == VectorStatus::valid;
        for (std::string const& method : uncertainty_methods()) {
          settings.uncertainty = method;
          estimate_uncertainty(field, frames, settings);
          auto const quality_on = [&](std::vector<Vec2d> const& right) {
            return uncertainty_quality(field.displacement_px, right, field.sigma_px, mask);
          };
          UncertaintyQuality const window = quality_on(on.window), deformed = quality_on(on.deformed_window),
                                   total = quality_on(point);
          samples[{method, flow.name, noise}].push_back({window.coverage_1, deformed.coverage_1, total.coverage_1,
                                                         window.rms_ratio, deformed.rms_ratio, total.rms_ratio});
        }
      }
    }
  }
  std::vector<CoverageRow> rows;
  for (std::string const& method : uncertainty_methods())
    for (TestedFlow const& flow : flows)
      for (double const noise : noises) {
        std::vector<Sample> const& of = samples[{method, flow.name, noise}];
        rows.push_back({method, flow.name, noise, mean_of(of, &Sample::window), mean_of(of, &Sample::deformed_window),
                        mean_of(of, &Sample::total), mean_of(of, &Sample::rms_ratio),
                        mean_of(of, &Sample::rms_ratio_deformed_window), mean_of(of, &Sample::rms_ratio_total)});
      }
  return rows;
}

UncertaintyCombination learn_combination(Backend const& device) {
  std::vector<std::string> methods = uncertainty_methods();
  std::erase(methods, "combination");
  DisplacementAt const flows[] = {uniform_flow({0.3, -0.6}), shear_flow(0.02, learning_pixels), [](Vec2d p) {
                                    return Vec2d{0.006 * (p.x - 255.5), -0.006 * (p.y - 255.5)};
                                  }};
  std::vector<UncertaintySample> samples;
  std::uint64_t seed = first_learning_seed;
  for (DisplacementAt const& flow : flows)
    for (double const noise : {0.01, 0.02, 0.05, 0.1})
      for (auto const& [diameter, per_window] : {Seeding{3.0, 20.0}, {2.2, 12.0}, {4.5, 20.0}, {3.0, 40.0}}) {
        ParticlePair pair = render_particle_pair({.columns = learning_pixels,
                                                  .rows = learning_pixels,
                                                  .diameter_px = diameter,
                                                  .particles_per_px = per_window / 1024.0,
                                                  .noise = noise,
                                                  .seed = seed++},
                                                 flow);
        spdlog::info("learning: {} pairs", seed - first_learning_seed);
        CorrelationSettings settings;
        HostFrames const frames(std::move(pair.reference), std::move(pair.flow));
        DisplacementField field = correlate_frames(frames, settings, device).field;
        // These flows are linear across a window, so that deformed windows measure the displacement at their centres.
        std::vector<Vec2d> const truth = truth_at_vectors(field, flow);
        VectorMask const mask = benchmark_mask(field, learning_pixels, learning_pixels);
        std::vector<std::vector<Vec2d>> sigmas;
        for (std::string const& method : methods) {
          settings.uncertainty = method;
          estimate_uncertainty(field, frames, settings);
          sigmas.push_back(field.sigma_px);
        }
        for (std::size_t i = 0; i < field.size(); ++i) {
          Vec2d const error = field.displacement_px[i] - truth[i];
          if (!mask[i] || field.status[i] != VectorStatus::valid || !(length(error) <= gross_error_px)) continue;
          for (double Vec2d::*axis : {&Vec2d::x, &Vec2d::y}) {
            UncertaintySample sample{{}, error.*axis};
            for (std::vector<Vec2d> const& sigma : sigmas) sample.log_sigma.push_back(std::log(sigma[i].*axis));
            bool const known = std::all_of(sample.log_sigma.begin(), sample.log_sigma.end(),
                                           [](double value) { return std::isfinite(value); });
            if (known) samples.push_back(std::move(sample));
          }
        }
      }
  return fit_combination(samples, methods);
}

}  // namespace gladstone::inline benchmarks
