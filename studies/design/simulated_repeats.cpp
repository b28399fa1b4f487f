#include "studies/design/simulated_repeats.h"

#include <algorithm>
#include <cmath>

#include "render/base/not_a_number.h"
#include "render/method.h"
#include "studies/design/predicted_blur.h"

namespace gladstone::inline design {
namespace {

bool inside(Vec2d place, Setup const& setup, double border) {
  return place.x >= border && place.y >= border && place.x <= setup.camera.columns - 1 - border &&
         place.y <= setup.camera.rows - 1 - border;
}

/// Returns the mean over the repeats; NaN at vectors that are invalid in any of them.
std::vector<Vec2d> mean_of(std::vector<std::vector<Vec2d>> const& repeats) {
  std::vector<Vec2d> mean(repeats.front().size());
  for (auto const& one : repeats) {
    for (std::size_t i = 0; i < mean.size(); ++i) mean[i] += one[i] / static_cast<double>(repeats.size());
  }
  return mean;
}

/// Returns the rms over the components of the vectors for which `counts` is finite.
double compute_rms(std::vector<Vec2d> const& values, std::vector<Vec2d> const& counts) {
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!is_finite(counts[i]) || !is_finite(values[i])) continue;
    sum += dot(values[i], values[i]);
    count += 2;
  }
  return count > 0 ? std::sqrt(sum / static_cast<double>(count)) : not_a_number;
}

/// Returns the number of lattice vectors per independent window, since windows overlap.
double vectors_per_window(std::vector<Vec2d> const& place, int window_px) {
  double spacing = window_px;
  for (std::size_t i = 1; i < place.size(); ++i) {
    double const step = place[i].x - place[i - 1].x;
    if (step > 0) spacing = std::min(spacing, step);
  }
  double const across = window_px / spacing;
  return std::max(1.0, across * across);
}

/// Returns a budget term of one repeat; zeros if it is unknown.
std::vector<Vec2d> term_of(Repeats const& repeats, std::size_t repeat, std::string const& name) {
  for (BudgetStage const& stage : repeats.causes[repeat]) {
    if (stage.name == name) return stage.displacement_px;
  }
  return std::vector<Vec2d>(repeats.place.size());
}

std::vector<Vec2d> mean_term(Repeats const& repeats, std::string const& name) {
  std::vector<std::vector<Vec2d>> terms;
  for (std::size_t k = 0; k < repeats.causes.size(); ++k) terms.push_back(term_of(repeats, k, name));
  return mean_of(terms);
}

std::vector<Vec2d> sum_of(std::vector<Vec2d> a, std::vector<Vec2d> const& b, double sign) {
  for (std::size_t i = 0; i < a.size(); ++i) a[i] += sign * b[i];
  return a;
}

/// Returns the amplitude of a displacement relative to Eq. 9, by least squares over the vectors for which `counts` is
/// finite.
double fit_amplitude(std::vector<Vec2d> const& displacement, Repeats const& repeats, std::vector<Vec2d> const& counts) {
  double product = 0, square = 0;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (!is_finite(counts[i])) continue;
    product += dot(displacement[i], repeats.eq9[i]);
    square += dot(repeats.eq9[i], repeats.eq9[i]);
  }
  return product / square;
}

}  // namespace

void enter(Repeats& repeats, ObservedCase const& seen, double border) {
  Comparison const& all = seen.comparison;
  if (repeats.error.empty()) {
    repeats.place = all.measured.position_px;
    repeats.eq9 = all.point.eq9_px;
    repeats.cone = all.point.eq9_cone_px;
    repeats.refraction = all.thin_lens;
    repeats.lens = all.point.displacement_px;
    repeats.setup = seen.prepared.scene.setup;
    repeats.magnification = seen.prepared.scene.imaging.magnification;
    RenderPlan const& plan = seen.prepared.plan;
    bool const plain = plan.method == RenderMethod::focused_dots && plan.fineness == 1;
    if (plain && !plan.adaptive_criteria) repeats.rays = plan.rays;
  }
  std::vector<Vec2d>& error = repeats.error.emplace_back(all.mask.size(), Vec2d{not_a_number, not_a_number});
  for (std::size_t i = 0; i < all.mask.size(); ++i) {
    if (!all.mask[i] || !inside(all.measured.position_px[i], seen.prepared.scene.setup, border)) continue;
    error[i] = all.measured.displacement_px[i] - all.point.eq9_px[i];
    repeats.displacement_px = std::max(repeats.displacement_px, length(all.point.displacement_px[i]));
  }
  repeats.causes.push_back(budget_differences(all));
}

void add_errors(SimulatedDesign& bench, Repeats const& repeats, DesignPoint<double> const& formulas) {
  RepeatSplit const split = split_repeats(repeats.error);
  bench.vectors = split.vectors;
  auto const count = static_cast<double>(repeats.error.size());
  double const independent = std::max(1.0, 2 * static_cast<double>(split.vectors) /
                                               vectors_per_window(repeats.place, formulas.given->window.window_px()));
  bench.random_px = {split.scatter_px, split.scatter_px / std::sqrt(2 * independent * (count - 1))};
  double const variance = split.scatter_px * split.scatter_px / count,
               bias2 = split.systematic_px * split.systematic_px;
  double const error2 = std::sqrt((variance * variance + 2 * bias2 * variance) * 2 / independent);
  bench.bias_px = {split.systematic_px, std::sqrt(bias2 + error2) - split.systematic_px};
  std::vector<Vec2d> const counts = mean_of(repeats.error);
  PredictedBlur const blur = predicted_blur(*repeats.setup, formulas, repeats.place);
  bench.predicted_bias_px = compute_rms(blur.whole_px, counts);
  // Add the terms of window and estimator: the part of the sum that all dot patterns have in common is the window's
  // bias.
  std::vector<std::vector<Vec2d>> window;
  for (std::size_t k = 0; k < repeats.error.size(); ++k) {
    window.push_back(sum_of(term_of(repeats, k, "window"), term_of(repeats, k, "estimator"), 1));
    for (std::size_t i = 0; i < counts.size(); ++i) window[k][i] += 0.0 * counts[i];  // NaN at invalid vectors
  }
  bench.causes = {
      {"cone", compute_rms(mean_term(repeats, "cone"), counts), compute_rms(blur.cone_px, counts)},
      {"window", split_repeats(window).systematic_px, compute_rms(sum_of(blur.whole_px, blur.cone_px, -1), counts)},
      {"refraction", compute_rms(mean_term(repeats, "refraction"), counts), 0},
      {"aberration", compute_rms(mean_term(repeats, "aberration"), counts), 0},
      {"small_angle", compute_rms(mean_term(repeats, "small_angle"), counts), 0}};
}

WaveShares compute_wave_shares(Repeats const& repeats, double wavelength, int window_px) {
  std::vector<Vec2d> const error = mean_of(repeats.error);
  WaveShares shares;
  shares.wavelength = wavelength;
  shares.cone = fit_amplitude(repeats.cone, repeats, error);
  shares.refraction = fit_amplitude(repeats.refraction, repeats, error);
  shares.lens = fit_amplitude(repeats.lens, repeats, error);
  shares.measured.value = 1 + fit_amplitude(error, repeats, error);
  // Noise projected on the wave: scatter of a mean over repeats, for the number of independent windows.
  double square = 0;
  for (std::size_t i = 0; i < error.size(); ++i)
    square += is_finite(error[i]) ? dot(repeats.eq9[i], repeats.eq9[i]) : 0;
  double const scatter = split_repeats(repeats.error).scatter_px;
  shares.measured.standard_error = scatter * std::sqrt(vectors_per_window(repeats.place, window_px) / square /
                                                       static_cast<double>(repeats.error.size()));
  return shares;
}

}  // namespace gladstone::inline design
