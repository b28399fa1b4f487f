#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <cmath>

#include "analysis/uncertainty/uncertainty.h"
#include "studies/benchmark/benchmark_run.h"
#include "studies/compare/correlate.h"

namespace gladstone::inline benchmarks {
namespace {

constexpr int learning_pixels = 512;
/// First of the seeds that are reserved for the training set.
constexpr std::uint64_t first_learning_seed = 9001;

struct Seeding {
  double diameter_px, per_window;
};

}  // namespace

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
