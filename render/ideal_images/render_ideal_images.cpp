#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <utility>

#include "render/base/freed_memory.h"
#include "render/base/not_a_number.h"
#include "render/base/parallel.h"
#include "render/ideal_images/draw_light.h"
#include "render/ideal_images/ideal_images.h"
#include "render/scene/particle_scene.h"

namespace gladstone::inline ideal_images {
namespace {

constexpr int frames = 2;
constexpr int band_rows = 64;  // rows of an image that one thread renders at a time

/// Copies of the particle images that overlap each band of image rows, in their order. Sums within a band therefore
/// have a fixed order, independent of the thread that renders it.
class Bands {
 public:
  Bands(std::vector<ParticleImage> const& spots, int rows, int half)
      : begin_(static_cast<std::size_t>((rows + band_rows - 1) / band_rows) + 1) {
    auto const each = [&](auto const& enter) {
      for (std::size_t i = 0; i < spots.size(); ++i) {
        if (!(spots[i].light > 0)) continue;
        double const first = std::floor(spots[i].at.y + 0.5) - half, last = first + 2 * half;
        if (last < 0 || first > rows - 1) continue;
        int const from = static_cast<int>(std::max(first, 0.0)) / band_rows;
        int const to = static_cast<int>(std::min(last, rows - 1.0)) / band_rows;
        for (int band = from; band <= to; ++band) enter(static_cast<std::size_t>(band), i);
      }
    };
    each([this](std::size_t band, std::size_t) { ++begin_[band + 1]; });
    for (std::size_t band = 1; band < begin_.size(); ++band) begin_[band] += begin_[band - 1];
    listed_.resize(begin_.back());
    std::vector<std::size_t> next(begin_.begin(), begin_.end() - 1);
    each([&](std::size_t band, std::size_t spot) { listed_[next[band]++] = spots[spot]; });
  }
  std::size_t count() const { return begin_.size() - 1; }
  std::span<ParticleImage const> operator[](std::size_t band) const {
    return {listed_.data() + begin_[band], listed_.data() + begin_[band + 1]};
  }

 private:
  std::vector<std::size_t> begin_;
  std::vector<ParticleImage> listed_;
};

/// Light of the rows of one band, with a margin on both sides, so that particle images are not clipped. A row is an odd
/// number of cache lines long: the rows of an image of 2^n columns would compete for the same few lines of the cache.
class BandLight {
 public:
  BandLight(int columns, int rows, int margin)
      : margin_(margin),
        stride_(8 * static_cast<std::size_t>(((columns + 2 * margin) / 8 + 1) | 1)),
        light_(stride_ * static_cast<std::size_t>(rows)) {}
  /// Returns the pixel of a row whose column is from -margin to columns + margin - 1.
  double* pixel(int column, int row) {
    return light_.data() + stride_ * static_cast<std::size_t>(row) + (column + margin_);
  }

 private:
  int margin_;
  std::size_t stride_;
  std::vector<double> light_;
};

/// Adds the particle images of a band to its rows.
void draw_band(std::span<ParticleImage const> spots, std::size_t band, GaussianSpot<double> const& shape,
               Image<double>& image) {
  int const width = 2 * shape.half_width() + 1, filled = (width + 3) / 4 * 4;
  int const top = static_cast<int>(band) * band_rows, rows = std::min(band_rows, image.rows() - top);
  BandLight light(image.columns(), rows, filled);
  std::vector<double> across(static_cast<std::size_t>(filled)), down(across.size());  // zero beyond `width`
  for (ParticleImage const& spot : spots) {
    if (!(std::abs(spot.at.x) < 1e8)) continue;
    Footprint const print = shape.footprint(spot.at);
    if (print.column + width <= 0 || print.column >= image.columns()) continue;
    GaussianSpot<double> const own{spot.sigma};
    own.shares(spot.at.x, print.column, width, across.data());
    own.shares(spot.at.y, print.row, width, down.data());
    int const above = std::max(0, top - print.row), end = std::min(width, top + rows - print.row);
    for (int i = above; i < end; ++i) {
      double const brightness = spot.light * down[static_cast<std::size_t>(i)];
      double* const row = light.pixel(print.column, print.row + i - top);
      for (int k = 0; k < filled; k += 4) {
        for (int j = k; j < k + 4; ++j) row[j] += brightness * across[static_cast<std::size_t>(j)];
      }
    }
  }
  for (int row = 0; row < rows; ++row) std::copy_n(light.pixel(0, row), image.columns(), &image(0, top + row));
}

/// Returns the PSF of the widest image that is not faint. Its footprint is used for all images.
GaussianSpot<double> find_widest(std::array<std::vector<ParticleImage>, frames> const& spots, double sigma) {
  double brightest = 0;
  for (auto const& frame : spots)
    for (ParticleImage const& spot : frame) brightest = std::max(brightest, spot.light);
  for (auto const& frame : spots)
    for (ParticleImage const& spot : frame)
      if (spot.light > faint_image * brightest) sigma = std::max(sigma, spot.sigma);
  return {sigma};
}

/// Returns the truth of particles with given image positions, and light in photons.
GroundTruth truth_of(Particles const& particles, std::array<std::vector<ParticleImage>, frames> const& spots) {
  GroundTruth truth;
  truth.resize(particles.size());
  truth.position_m = particles.place[0];
  truth.particles.second_m = particles.place[1];
  truth.particles.diameter_m = particles.diameter;
  for (auto* const theory : {&truth.eq9_px, &truth.chief_px, &truth.eq9_cone_px})
    theory->assign(truth.size(), {not_a_number, not_a_number});
  parallel_chunks(truth.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      ParticleImage const &first = spots[0][i], &second = spots[1][i];
      bool const both = first.light > 0 && second.light > 0;
      truth.reference_px[i] = first.light > 0 ? first.at : Vec2d{not_a_number, not_a_number};
      truth.displacement_px[i] = both ? second.at - first.at : Vec2d{not_a_number, not_a_number};
      truth.displacement_error_px[i] = both ? Vec2d{} : Vec2d{not_a_number, not_a_number};
      truth.displacement_std_px[i] = second.light > 0 ? Vec2d{} : Vec2d{not_a_number, not_a_number};
      truth.flux[i] = {first.light, second.light};
    }
  });
  truth.particles.reference_ambient_px = truth.reference_px;
  truth.particles.displacement_ambient_px = truth.displacement_px;
  return truth;
}

}  // namespace

Image<double> draw_light(std::vector<ParticleImage> const& images, GaussianSpot<double> const& shape, int columns,
                         int rows) {
  Image<double> light(columns, rows);
  Bands const bands(images, rows, shape.half_width());
  parallel_for(bands.count(), [&](std::size_t band) { draw_band(bands[band], band, shape, light); });
  return light;
}

Rendering render_ideal_images(IdealImages const& ideal, Particles const& particles, ParticleLight light,
                              RenderImages images, ImageDrawer* drawer) {
  keep_freed_memory();  // Retain freed memory: for successive pairs, page faults took a third of the time.
  Scene const& scene = ideal.scene();
  LightThroughLens const through_lens(scene, light);
  IdealProjection const project = ideal.projection();
  DefocusBlur const blur = ideal.blur();
  std::array<std::vector<ParticleImage>, frames> spots;
  for (std::size_t pulse = 0; pulse < frames; ++pulse) {
    spots[pulse].resize(particles.size());
    parallel_chunks(particles.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        double const photons = particles.photons[pulse][i];
        if (!(photons > 0)) continue;
        Vec3d const place = particles.place[pulse][i];
        double const light = photons * through_lens(place, i, static_cast<int>(pulse));
        spots[pulse][i] = {project(place), light, blur.width(place.z)};
      }
    });
  }
  Rendering rendering;
  rendering.table = TableState::by_formula;
  rendering.truth = truth_of(particles, spots);
  if (images == RenderImages::no) return rendering;
  double const unit = photon_unit(scene, particles, light);
  for (auto& frame : spots) {
    for (ParticleImage& spot : frame) spot.light /= unit;
  }
  GaussianSpot<double> const shape = find_widest(spots, blur.sigma);
  CameraSetup const& camera = scene.setup.camera;
  if (drawer) {
    rendering.in_place = drawer->draw(spots, shape, camera.columns, camera.rows);
    if (images == RenderImages::yes) rendering.light = std::exchange(rendering.in_place, nullptr)->to_host();
    return rendering;
  }
  rendering.light = {draw_light(spots[0], shape, camera.columns, camera.rows),
                     draw_light(spots[1], shape, camera.columns, camera.rows)};
  if (images == RenderImages::in_place) rendering.store_light_in_place();
  return rendering;
}

}  // namespace gladstone::inline ideal_images
