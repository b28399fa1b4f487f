#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <random>
#include <vector>

#include "render/base/frame_pair.h"
#include "render/base/vec.h"

namespace gladstone::inline benchmarks {

/// Pair of particle images with a displacement that is known everywhere.
struct ParticlePair : FramePair<double> {
  /// Input of window_truth() for the particles visible in both frames: position in frame A [px], displacement [px], and
  /// the geometric mean of the peaks in both images, relative to the brightest particle [1].
  std::vector<Vec2d> dot_reference_px = {}, dot_displacement_px = {};
  std::vector<double> dot_light = {};
};

struct ParticleSettings {
  int columns = 256;
  int rows = 256;
  double diameter_px = 3.0;  ///< e^-2 diameter of a particle image
  double particles_per_px = 20.0 / 1024.0;
  double noise = 0.0;  ///< standard deviation relative to the peak of the brightest particle [1]
  std::uint64_t seed = 1;
  double pitch_px = 0.0;  ///< spacing of a square lattice of equal particles; 0: random positions and intensities
  /// Fraction of the particles of each frame without a partner in the other, replaced by new ones [1].
  double lost = 0.0;
  double flow_light = 1.0;   ///< brightness of frame B relative to frame A, including the background [1]
  double light_slope = 0.0;  ///< relative increase of flow_light across the image, from column 0 to the last column [1]
};

/// Renders 8-bit images of Gaussian particles integrated over the pixels. Particles are at -d/2 in frame A and +d/2 in
/// frame B, where d is `displacement` at the mid-position: the central displacement, which symmetric schemes measure.
inline ParticlePair render_particle_pair(ParticleSettings const& settings,
                                         std::function<Vec2d(Vec2d)> const& displacement) {
  constexpr double background = 25.5, peak = 153.0;
  constexpr int margin = 40, half = 5;
  std::mt19937_64 bits(settings.seed);
  auto const uniform = [&] { return static_cast<double>(bits() >> 11) * 0x1p-53; };
  double const sigma = settings.diameter_px / 4.0, scale = 1.0 / (std::sqrt(2.0) * sigma);
  Image<double> const dark(settings.columns, settings.rows, background);
  ParticlePair pair{{dark, dark}};
  auto const draw = [&](Image<double>& image, Vec2d at, double amplitude) {
    int const column = static_cast<int>(std::floor(at.x + 0.5)), row = static_cast<int>(std::floor(at.y + 0.5));
    double x[2 * half + 1], y[2 * half + 1];
    double const area = std::sqrt(std::acos(-1.0) / 2.0) * sigma;
    for (int k = -half; k <= half; ++k) {
      x[k + half] = area * (std::erf((column + k + 0.5 - at.x) * scale) - std::erf((column + k - 0.5 - at.x) * scale));
      y[k + half] = area * (std::erf((row + k + 0.5 - at.y) * scale) - std::erf((row + k - 0.5 - at.y) * scale));
    }
    for (int j = std::max(0, row - half); j <= std::min(image.rows() - 1, row + half); ++j)
      for (int i = std::max(0, column - half); i <= std::min(image.columns() - 1, column + half); ++i)
        image(i, j) += amplitude * x[i - column + half] * y[j - row + half];
  };
  auto const light = [&](double x) {
    return settings.flow_light * (1.0 + settings.light_slope * (x / settings.columns - 0.5));
  };
  auto const draw_in_both = [&](Vec2d at, double amplitude) {
    Vec2d const whole = displacement(at), half_way = 0.5 * whole;
    draw(pair.reference, at - half_way, amplitude);
    draw(pair.flow, at + half_way, amplitude);
    pair.dot_reference_px.push_back(at - half_way);
    pair.dot_displacement_px.push_back(whole);
    pair.dot_light.push_back(amplitude / peak * std::sqrt(light(at.x)));
  };
  if (settings.pitch_px > 0.0) {
    for (double y = -margin; y < settings.rows + margin; y += settings.pitch_px)
      for (double x = -margin; x < settings.columns + margin; x += settings.pitch_px) draw_in_both({x, y}, peak);
  } else {
    int const count = static_cast<int>(settings.particles_per_px * (settings.columns + 2.0 * margin) *
                                       (settings.rows + 2.0 * margin));
    for (int n = 0; n < count; ++n) {
      double const x = uniform() * (settings.columns + 2.0 * margin) - margin - 0.5;
      double const y = uniform() * (settings.rows + 2.0 * margin) - margin - 0.5;
      double const amplitude = peak * (0.5 + 0.5 * uniform());
      if (settings.lost > 0.0 && uniform() < settings.lost) {
        draw(pair.reference, {x, y}, amplitude);
        double const other_x = uniform() * (settings.columns + 2.0 * margin) - margin - 0.5;
        draw(pair.flow, {other_x, uniform() * (settings.rows + 2.0 * margin) - margin - 0.5}, amplitude);
        continue;
      }
      draw_in_both({x, y}, amplitude);
    }
  }
  if (settings.flow_light != 1.0 || settings.light_slope != 0.0)
    for (int j = 0; j < settings.rows; ++j)
      for (int i = 0; i < settings.columns; ++i) pair.flow(i, j) *= light(i);
  for (Image<double>* image : {&pair.reference, &pair.flow})
    for (double& value : *image) {
      // Box-Muller transform
      if (settings.noise > 0.0)
        value += settings.noise * peak * std::sqrt(-2.0 * std::log(1.0 - uniform())) *
                 std::cos(2.0 * std::acos(-1.0) * uniform());
      value = std::clamp(std::round(value), 0.0, 255.0);
    }
  return pair;
}

}  // namespace gladstone::inline benchmarks
