#include "render/scene/ray_scatter.h"

#include <algorithm>
#include <cmath>

#include "render/base/not_a_number.h"
#include "render/base/parallel.h"
#include "render/scene/ray_hit.h"

namespace gladstone {
namespace {

/// Average properties of the dots in one image: sums over the pixels of a dot.
struct MeanDot {
  double light = 0, square = 0;  ///< sum of the light and of its square
  double variance = 0, lit = 0;  ///< sum over lit pixels of the light's variance, and their number
};

}  // namespace

MeanDisplacement MeanDisplacement::of(Vec2d const (&found)[budget_scramblings]) {
  auto const shown = [](Vec2d one) { return std::isfinite(one.x); };
  MeanDisplacement result;
  if (std::none_of(std::begin(found), std::end(found), shown)) return {{not_a_number, not_a_number}, not_a_number};
  auto const moved = [&shown](Vec2d one) { return shown(one) ? one : Vec2d{}; };
  for (Vec2d const one : found) result.mean += moved(one) / static_cast<double>(budget_scramblings);
  for (Vec2d const one : found) {
    Vec2d const off = moved(one) - result.mean;
    result.variance += 0.5 * dot(off, off);
  }
  result.variance /= budget_scramblings - 1;
  return result;
}

double mean_variance(std::vector<MeanDisplacement> const& displacements) {
  double sum = 0, count = 0;
  for (MeanDisplacement const& one : displacements) {
    if (std::isnan(one.variance)) continue;
    sum += one.variance;
    ++count;
  }
  return sum / count;
}

int error_bit_depth(CameraSetup const& camera) { return std::min(camera.bit_depth, 12); }

GreyLevels::GreyLevels(CameraSetup const& camera, double dots_per_pixel)
    : density(dots_per_pixel), bits(error_bit_depth(camera)) {
  double const full_scale = std::pow(2.0, bits) - 1;
  // A given exposure determines the light of a grey level; "auto" puts the brightest pixel at 90 % of full scale.
  level = camera.exposure_e ? camera.noise.full_well_e / *camera.exposure_e / full_scale : 0.0;
  at_peak = 0.9 * full_scale;
}

double GreyLevels::error(Scatter const& scatter) const {
  double const light_per_level = level > 0 ? level : scatter.brightest / at_peak;
  return light_per_level > 0 ? std::sqrt(scatter.light_variance) / light_per_level : not_a_number;
}

Scatter measure_scatter(std::vector<std::size_t> const& dots, GreyLevels const& levels,
                        std::function<Sampled(std::size_t dot, int scrambling)> const& sample) {
  struct PerDot {
    std::vector<double> mean, variance;  // mean and variance of the light of each pixel
  };
  Scatter scatter;
  scatter.displacements.resize(dots.size());
  std::vector<PerDot> measured(dots.size());
  parallel_for(dots.size(), [&](std::size_t index) {
    std::vector<Sampled> samples;
    for (int scrambling = 0; scrambling < budget_scramblings; ++scrambling) {
      samples.push_back(sample(dots[index], scrambling));
    }
    PerDot& result = measured[index];
    auto const unbiased = [&](auto const& value_of) {
      double mean = 0, square = 0;
      for (Sampled const& one : samples) mean += value_of(one) / budget_scramblings;
      for (Sampled const& one : samples) square += (value_of(one) - mean) * (value_of(one) - mean);
      return std::pair{mean, square / (budget_scramblings - 1)};
    };
    Vec2d found[budget_scramblings];
    for (std::size_t k = 0; k < samples.size(); ++k) found[k] = samples[k].displacement;
    scatter.displacements[index] = MeanDisplacement::of(found);
    for (std::size_t i = 0; i < samples[0].light.size(); ++i) {
      auto const [mean, variance] = unbiased([i](Sampled const& s) { return s.light[i]; });
      result.mean.push_back(mean);
      result.variance.push_back(variance);
    }
  });

  auto const share = 1 / static_cast<double>(dots.size());
  MeanDot frames[frame_count];
  auto const sum_over_frame = [&](int frame, auto const& add) {
    for (PerDot const& dot : measured) {
      std::size_t const area = dot.mean.size() / frame_count, first = static_cast<std::size_t>(frame) * area;
      for (std::size_t i = first; i < first + area; ++i) add(dot.mean[i], dot.variance[i]);
    }
  };
  for (int frame = 0; frame < frame_count; ++frame) {
    MeanDot& sums = frames[frame];
    sum_over_frame(frame, [&](double mean, double variance) {
      sums.light += share * mean;
      sums.square += share * (mean * mean + variance * (1 - 1.0 / budget_scramblings));  // for one scrambling
      scatter.brightest = std::max(scatter.brightest, mean);
    });
    // Light of randomly overlapping dots: mean plus three standard deviations (Campbell's theorem).
    double const overlapping = levels.density * sums.light + 3 * std::sqrt(levels.density * sums.square);
    scatter.brightest = std::max(scatter.brightest, overlapping);
  }
  scatter.light_variance = not_a_number;
  double const threshold = levels.level > 0 ? levels.level : scatter.brightest / levels.at_peak;
  for (int frame = 0; frame < frame_count; ++frame) {
    MeanDot& sums = frames[frame];
    sum_over_frame(frame, [&](double mean, double variance) {
      if (mean < threshold) return;
      sums.variance += share * variance;
      sums.lit += share;
    });
    // With n dots per pixel of k lit pixels each, the lit fraction of the image is 1 - exp(-n k). Variances of
    // overlapping dots add up.
    double const density = levels.density;
    double const pixels = density > 0 ? -std::expm1(-density * sums.lit) / density : sums.lit;
    if (pixels > 0) scatter.light_variance = std::fmax(scatter.light_variance, sums.variance / pixels);
  }
  return scatter;
}

std::vector<std::size_t> dots_in_view(Scene const& scene) {
  std::vector<std::size_t> in_view;
  for (std::size_t dot = 0; dot < scene.source_count(); ++dot) {
    if (scene.source_in_view(dot)) in_view.push_back(dot);
  }
  if (in_view.empty() && scene.source_count() > 0) in_view.push_back(0);
  return in_view;
}

std::vector<std::size_t> choose_sample(std::vector<std::size_t> const& dots, std::size_t count) {
  if (dots.size() <= count) return dots;
  std::vector<std::size_t> sample;
  for (std::size_t i = 0; i < count; ++i) sample.push_back(dots[i * dots.size() / count]);
  return sample;
}

}  // namespace gladstone
