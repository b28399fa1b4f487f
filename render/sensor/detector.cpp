#include "render/sensor/detector.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>
#include <cstring>

#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/files/image_file.h"

namespace gladstone::inline sensor {
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
        ErrorCode::invalid_value, path,
        "cannot be used as glare (it is black, or has negative or non-finite pixels); choose another image");
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

/// Pixels that are recorded together, in loops that the compiler vectorises: the same operations as
/// PixelDetector::record(), in another order. @tparam patterned  whether pixels differ in gain, offset and dark charge
template <bool patterned>
class PixelBlock {
 public:
  static constexpr std::size_t size = 512;

  PixelBlock(PixelDetector const& detector, RandomStream stream, std::size_t first, std::size_t count)
      : detector_(detector), first_(first), count_(count) {
    std::uint64_t state = detector.frame_noise(stream).state(first);
    for (std::size_t i = 0; i < count; ++i) {
      shot_[i] = to_open_unit(mix64(state));
      read_[i] = to_open_unit(mix64(state + FrameNoise::increment));
      state += 2 * FrameNoise::increment;
    }
    for (std::size_t i = 0; patterned && i < count; ++i) pattern_[i] = detector.pattern(first + i);
  }

  /// Records the pixels. @return number of saturated pixels
  std::size_t record(double const* light, std::uint16_t* levels) {
    PixelDetector const detector = detector_;
    if (detector.columns > 0) {
      for (std::size_t i = 0; i < count_; ++i) charge_[i] = detector.mean_charge(light[i], first_ + i, pattern(i));
    } else {  // loop for sensors without stray light
      for (std::size_t i = 0; i < count_; ++i) charge_[i] = detector.with_dark_charge(light[i], 0, pattern(i));
    }
    if (detector.shot_noise) draw_electrons();
    find_quantiles(read_);
    std::size_t saturated = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      PixelLevel const here = detector.read_out(charge_[i], pattern(i), quantile_[i]);
      expanded_[i] = here.level;
      saturated += here.saturated ? 1 : 0;
    }
    for (std::size_t i = 0; i < count_; ++i) levels[i] = static_cast<std::uint16_t>(static_cast<int>(expanded_[i]));
    return saturated;
  }

 private:
  using Numbers = std::array<double, size>;
  using Four = double __attribute__((vector_size(4 * sizeof(double))));  ///< vector type of GCC and clang
  static constexpr std::size_t fours = 2, group = 4 * fours;             ///< number of pixels that are processed
                                                                         ///< together
  static_assert(size % group == 0);

  PixelPattern pattern(std::size_t i) const {
    if constexpr (patterned) return pattern_[i];
    return {};
  }
  /// Computes the normal quantiles of uniform numbers: first as if all were central, then the few in the tails.
  void find_quantiles(Numbers const& uniform) {
    for (std::size_t i = 0; i < count_; ++i) quantile_[i] = NormalQuantile::central(uniform[i]);
    for (std::size_t i = 0; i < count_; ++i) {
      if (!NormalQuantile::is_central(uniform[i])) quantile_[i] = NormalQuantile::tail(uniform[i]);
    }
  }
  /// Replaces mean charges by numbers of electrons: first as if all were large, then the small ones.
  void draw_electrons() {
    constexpr double least = PoissonQuantile::least_expanded;
    find_quantiles(shot_);
    for (std::size_t i = 0; i < count_; ++i) {
      double const charge = charge_[i];
      expanded_[i] = PoissonQuantile::expanded(charge > least ? charge : least, quantile_[i]);
    }
    draw_few_electrons();
    charge_ = expanded_;
  }
  /// Draws the numbers of electrons of all pixels but those for which the expansion is valid.
  void draw_few_electrons() {
    auto const is_expanded = [&](std::size_t i) {
      return charge_[i] >= PoissonQuantile::least_expanded && charge_[i] < 1e12;
    };
    // List the pixels with few electrons. Branches are avoided, because a processor would mispredict them.
    std::size_t few = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      selected_[few] = static_cast<std::uint16_t>(i);
      few += is_expanded(i) ? 0 : 1;
    }
    for (std::size_t k = 0; k < few; ++k) {
      double const charge = charge_[selected_[k]];
      mean_[k] = charge > 0 && charge < PoissonQuantile::least_expanded ? charge : 0;
      quantile_[k] = shot_[selected_[k]];
    }
    // Fill the last group with pixels of which none has an electron.
    for (std::size_t k = few; k % group != 0; ++k) mean_[k] = quantile_[k] = 0;
    for (std::size_t k = 0; k < few; ++k) share_[k] = PoissonQuantile::probability_of_none(mean_[k]);
    for (std::size_t k = few; k % group != 0; ++k) share_[k] = 1;
    for (std::size_t k = 0; k < few; k += group) count_electrons(k);
    for (std::size_t k = 0; k < few; ++k) {
      std::size_t const pixel = selected_[k];
      expanded_[pixel] = mean_[k] > 0 ? share_[k] : charge_[pixel];
    }
  }
  /// Replaces share_, the probability of no electrons, of a group of listed pixels by the number of cumulative
  /// probabilities that do not exceed the random number, like PoissonQuantile::summed().
  void count_electrons(std::size_t from) {
    Four mean[fours], uniform[fours], share[fours], sum[fours], electrons[fours] = {};
    for (std::size_t i = 0; i < fours; ++i) {
      std::memcpy(&mean[i], &mean_[from + 4 * i], sizeof(Four));
      std::memcpy(&uniform[i], &quantile_[from + 4 * i], sizeof(Four));
      std::memcpy(&share[i], &share_[from + 4 * i], sizeof(Four));
      sum[i] = share[i];
    }
    Four const none = {}, one = none + 1.0;
    for (int k = 1; k <= PoissonQuantile::most_terms; ++k) {
      double const per_k = 1.0 / k;
      auto any = none > one;
      for (std::size_t i = 0; i < fours; ++i) {
        auto const more = uniform[i] >= sum[i];
        any |= more;
        electrons[i] += more ? one : none;
        share[i] *= mean[i] * per_k;
        sum[i] += share[i];
      }
      if (k % 4 == 1 && (any[0] | any[1] | any[2] | any[3]) == 0) break;
    }
    for (std::size_t i = 0; i < fours; ++i) std::memcpy(&share_[from + 4 * i], &electrons[i], sizeof(Four));
  }

  PixelDetector const& detector_;
  std::size_t first_, count_;
  Numbers shot_, read_, charge_, quantile_, expanded_;
  Numbers mean_, share_;  // data of pixels with few electrons, in the order of selected_
  std::array<std::uint16_t, size> selected_;
  std::array<PixelPattern, patterned ? size : 1> pattern_;
};

/// Records pixels `begin` to `end`. @return number of saturated pixels
template <bool patterned>
std::size_t record_blocks(PixelDetector const& detector, RandomStream stream, double const* light, std::size_t begin,
                          std::size_t end, std::uint16_t* levels) {
  using Block = PixelBlock<patterned>;
  std::size_t saturated = 0;
  for (std::size_t i = begin; i < end; i += Block::size) {
    saturated += Block(detector, stream, i, std::min(Block::size, end - i)).record(light + i, levels + i);
  }
  return saturated;
}

/// Records pixels `begin` to `end` of a camera without noise. @return number of saturated pixels
std::size_t record_without_noise(PixelDetector const& detector, double const* light, std::size_t begin, std::size_t end,
                                 std::uint16_t* levels) {
  std::size_t saturated = 0;
  for (std::size_t i = begin; i < end; ++i) {
    PixelLevel const here = detector.record(light[i], RandomStream::noise_reference, i);
    levels[i] = static_cast<std::uint16_t>(here.level);
    saturated += here.saturated ? 1 : 0;
  }
  return saturated;
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
    double const* const from = light.data();
    std::uint16_t* const to = recording.image.data();
    saturated += !pixel_.noisy      ? record_without_noise(pixel_, from, begin, end, to)
                 : pixel_.patterned ? record_blocks<true>(pixel_, stream, from, begin, end, to)
                                    : record_blocks<false>(pixel_, stream, from, begin, end, to);
  });
  recording.saturated = saturated;
  return recording;
}

}  // namespace gladstone::inline sensor
