#include "render/sensor/detector.h"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/files/image_file.h"

namespace gladstone {
namespace {

/// Returns the noise seed of a frame of a sequence, independent of the seeds of repetitions (repeat_seed()).
std::uint64_t frame_seed(std::uint64_t seed, std::uint64_t frame) { return repeat_seed(mix64(seed), frame + 1); }

double full_scale_of(CameraSetup const& camera) { return std::pow(2.0, camera.bit_depth) - 1; }

/// Reads an image, resamples it bilinearly to `columns` x `rows` pixels, and scales its maximum to `most`.
Image<double> stretched(std::string const& path, int columns, int rows, double most) {
  Image<double> const picture = read_image(path);
  double const brightest = *std::max_element(picture.begin(), picture.end());
  if (count_not_finite(picture) > 0 || *std::min_element(picture.begin(), picture.end()) < 0 || !(brightest > 0)) {
    throw DataError(
        path, "cannot be used as glare (it is black, or has negative or non-finite pixels); choose another image");
  }
  Image<double> image(columns, rows);
  auto const place = [](int at, int count, int of) { return std::clamp((at + 0.5) * of / count - 0.5, 0.0, of - 1.0); };
  for (int row = 0; row < rows; ++row) {
    double const v = place(row, rows, picture.rows());
    int const j = static_cast<int>(v), below = std::min(j + 1, picture.rows() - 1);
    for (int column = 0; column < columns; ++column) {
      double const u = place(column, columns, picture.columns());
      int const i = static_cast<int>(u), right = std::min(i + 1, picture.columns() - 1);
      double const upper = picture(i, j) + (u - i) * (picture(right, j) - picture(i, j));
      double const lower = picture(i, below) + (u - i) * (picture(right, below) - picture(i, below));
      image(column, row) = most / brightest * (upper + (v - j) * (lower - upper));
    }
  }
  return image;
}

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
  if (noise.frames) {
    pixel_.by_frame = true;
    pixel_.seed = frame_seed(noise.seed, (*noise.frames)[0]);
    pixel_.flow_seed = frame_seed(noise.seed, (*noise.frames)[1]);
  }
  pixel_.patterned = noise.patterned();
  pixel_.prnu = noise.prnu;
  pixel_.dsnu_e = noise.dsnu_e;
  pixel_.hot_pixel_share = noise.hot_pixel_share;
  pixel_.hot_pixel_e = noise.hot_pixel_e;
  pixel_.pattern_seed = noise.pattern_seed;
  BackgroundSetup const& background = camera.background;
  if (background.most_e() > 0) {
    pixel_.columns = camera.columns;
    pixel_.rows = camera.rows;
    pixel_.background_e = background.level_e;
    pixel_.across_e = background.gradient_e.x;
    pixel_.down_e = background.gradient_e.y;
  }
  if (!background.glare_file.empty()) {
    glare_ = std::make_shared<Image<double> const>(
        stretched(background.glare_file, camera.columns, camera.rows, background.glare_e));
    pixel_.glare_e = glare_->data();
  }
}

double Detector::auto_exposure(CameraSetup const& camera, double brightest_light) {
  double const full_scale = full_scale_of(camera);
  if (!(brightest_light > 0)) return camera.noise.full_well_e;
  double const room_e = (0.9 * full_scale - camera.offset_dn) / full_scale * camera.noise.full_well_e;
  return std::max(room_e - camera.background.most_e(), 0.05 * camera.noise.full_well_e) / brightest_light;
}

Image<double> Detector::ideal(Image<double> const& light) const {
  Image<double> levels(light.columns(), light.rows());
  std::transform(light.begin(), light.end(), levels.begin(), [this](double value) { return ideal_level(value); });
  return levels;
}

Recording Detector::record(Image<double> const& light, RandomStream stream) const {
  Recording recording{Image<std::uint16_t>(light.columns(), light.rows()), 0};
  GLADSTONE_EXPECTS(!glare_ || glare_->size() == light.size());
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
