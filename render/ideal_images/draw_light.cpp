#include "render/ideal_images/draw_light.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "render/base/parallel.h"

namespace gladstone::inline ideal_images {
namespace {

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

}  // namespace

Image<double> draw_light(std::vector<ParticleImage> const& images, GaussianSpot<double> const& shape, int columns,
                         int rows) {
  Image<double> light(columns, rows);
  Bands const bands(images, rows, shape.half_width());
  parallel_for(bands.count(), [&](std::size_t band) { draw_band(bands[band], band, shape, light); });
  return light;
}

}  // namespace gladstone::inline ideal_images
