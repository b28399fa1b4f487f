#include "render/sensor/detector.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <random>

#include "render/base/parallel.h"

namespace gladstone {
namespace {

double full_scale_of(CameraSetup const& camera) { return std::pow(2.0, camera.bit_depth) - 1; }

}  // namespace

Detector::Detector(CameraSetup const& camera, double electrons_fully_lit)
    : noise_(camera.noise),
      full_scale_(full_scale_of(camera)),
      offset_(camera.offset_dn),
      electrons_(electrons_fully_lit),
      levels_per_light_(electrons_fully_lit * full_scale_ / camera.noise.full_well_e) {}

double Detector::auto_exposure(CameraSetup const& camera, double brightest_light) {
  double const full_scale = full_scale_of(camera);
  if (!(brightest_light > 0)) return camera.noise.full_well_e;
  return (0.9 * full_scale - camera.offset_dn) / full_scale * camera.noise.full_well_e / brightest_light;
}

Image<double> Detector::ideal(Image<double> const& light) const {
  Image<double> levels(light.columns(), light.rows());
  std::transform(light.begin(), light.end(), levels.begin(), [this](double value) { return ideal_level(value); });
  return levels;
}

Recording Detector::record(Image<double> const& light, RandomStream stream) const {
  Recording recording{Image<std::uint16_t>(light.columns(), light.rows()), 0};
  double const levels_per_electron = full_scale_ / noise_.full_well_e;
  std::atomic<std::size_t> saturated{0};
  parallel_chunks(light.size(), 4096, [&](std::size_t begin, std::size_t end) {
    std::size_t clipped = 0;
    for (std::size_t i = begin; i < end; ++i) {
      double electrons = light.data()[i] * electrons_;
      bool full = false;
      if (noise_.enabled) {
        KeyedEngine engine(noise_.seed, stream, i);
        electrons += noise_.dark_current_e;
        // beyond 1e12 electrons any pixel is full, and the library's Poisson sampling leaves its range
        if (noise_.shot_noise && electrons > 0 && electrons < 1e12) {
          electrons = static_cast<double>(std::poisson_distribution<long long>(electrons)(engine));
        }
        full = electrons >= noise_.full_well_e;
        electrons = std::min(electrons, noise_.full_well_e);
        if (noise_.read_noise_e > 0) electrons += std::normal_distribution<double>(0.0, noise_.read_noise_e)(engine);
      }
      double const level = std::floor(offset_ + electrons * levels_per_electron + 0.5);
      if (full || level >= full_scale_) ++clipped;
      recording.image.data()[i] = static_cast<std::uint16_t>(std::clamp(level, 0.0, full_scale_));
    }
    saturated += clipped;
  });
  recording.saturated = saturated;
  return recording;
}

}  // namespace gladstone
