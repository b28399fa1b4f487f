#include "render/rays/hit_grid.h"

#include <algorithm>
#include <cmath>

namespace gladstone::inline rays {
namespace {

constexpr std::uint64_t fewest_rays = 192;  // number of rays above which the grid is faster than individual PSFs

}  // namespace

bool HitGrid::is_faster_than_psfs(double sigma, std::uint64_t rays) {
  return rays >= fewest_rays && HitSpline::serves(sigma);
}

// Node 0 is in a margin in front of the tile; a hit at the tile's end reaches two nodes beyond it.
HitGrid::HitGrid(GaussianSpot<double> const& spot)
    : spline_(spot), view_(spline_.view()), side_((pad_px + tile_px) * view_.per_px + 3) {
  rows_seen_.resize(static_cast<std::size_t>(side_) * static_cast<std::size_t>(view_.pixels({0, side_})));
}

void HitGrid::deposit(Vec2d p, double weight, LightImage* image, double light_per_weight) {
  if (!(std::abs(p.x) < 1e7 && std::abs(p.y) < 1e7)) return;
  if (empty_) {
    first_ = {static_cast<int>(std::floor(p.x)) - tile_px / 2, static_cast<int>(std::floor(p.y)) - tile_px / 2};
    empty_ = false;
  }
  p -= Vec2d{static_cast<double>(first_.x), static_cast<double>(first_.y)};
  Vec2<int> const at{static_cast<int>(std::floor(p.x / tile_px)), static_cast<int>(std::floor(p.y / tile_px))};
  Tile& tile = tiles_[(at.y & (slots - 1)) * slots + (at.x & (slots - 1))];
  if (!tile.touched() || !(tile.at == at)) {
    flush(tile, image, light_per_weight);
    tile.at = at;
    tile.columns = tile.lines = {side_, 0};
    tile.light.resize(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_));
  }
  HitStencil const x((p.x - at.x * tile_px + pad_px) * view_.per_px), y((p.y - at.y * tile_px + pad_px) * view_.per_px);
  tile.columns = {std::min(tile.columns.low, x.first), std::max(tile.columns.high, x.first + 4)};
  tile.lines = {std::min(tile.lines.low, y.first), std::max(tile.lines.high, y.first + 4)};
  double* line = tile.light.data() + y.first * side_ + x.first;
  for (int j = 0; j < 4; ++j, line += side_) {
    double const share = weight * y.share[j];
    for (int i = 0; i < 4; ++i) line[i] += share * x.share[i];
  }
}

void HitGrid::flush(LightImage* image, double light_per_weight) {
  if (empty_) return;
  for (Tile& tile : tiles_) flush(tile, image, light_per_weight);
  empty_ = true;
}

void HitGrid::flush(Tile& tile, LightImage* image, double light_per_weight) {
  if (!tile.touched()) return;
  if (image) {
    int const left = first_.x + tile.at.x * tile_px - pad_px, top = first_.y + tile.at.y * tile_px - pad_px;
    blur_hits(
        SingleThread(), view_, tile.columns, tile.lines, tile.light.data(), side_, rows_seen_.data(),
        [&](int column, int row, double light) { image->add(left + column, top + row, light * light_per_weight); });
  }
  for (int line = tile.lines.low; line < tile.lines.high; ++line) {
    auto const from = tile.light.begin() + line * side_;
    std::fill(from + tile.columns.low, from + tile.columns.high, 0.0);
  }
  tile.columns = tile.lines = {0, 0};
}

}  // namespace gladstone::inline rays
