#include "render/sensor/detector.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "render/base/parallel.h"

namespace gladstone {
namespace {

double full_scale_of(CameraSetup const& camera) { return std::pow(2.0, camera.bit_depth) - 1; }

}  // namespace

Detector::Detector(CameraSetup const& camera, double electrons_fully_lit) {
  NoiseSetup const& noise = camera.noise;
  pixel_.electrons = electrons_fully_lit;
  pixel_.full_scale = full_scale_of(camera);
  pixel_.levels_per_electron = pixel_.full_scale / noise.full_well_e;
  pixel_.offset = camera.offset_dn;
  pixel_.noisy = noise.enabled;
  pixel_.shot_noise = noise.shot_noise;
  pixel_.full_well_e = noise.full_well_e;
  pixel_.dark_current_e = noise.dark_current_e;
  pixel_.read_noise_e = noise.read_noise_e;
  pixel_.seed = noise.seed;
}

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
  std::atomic<std::size_t> saturated{0};
  parallel_chunks(light.size(), 4096, [&](std::size_t begin, std::size_t end) {
    std::size_t clipped = 0;
    for (std::size_t i = begin; i < end; ++i) {
      PixelLevel const here = pixel_.record(light.data()[i], stream, i);
      recording.image.data()[i] = static_cast<std::uint16_t>(here.level);
      clipped += here.saturated ? 1 : 0;
    }
    saturated += clipped;
  });
  recording.saturated = saturated;
  return recording;
}

}  // namespace gladstone
