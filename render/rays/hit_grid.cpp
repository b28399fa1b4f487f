#include "render/rays/hit_grid.h"

#include <algorithm>
#include <cmath>

namespace gladstone {
namespace {

constexpr std::uint64_t fewest_rays = 192;  // beyond which blurring the grid takes less time than their spots

}  // namespace

bool HitGrid::pays(double sigma, std::uint64_t rays) { return rays >= fewest_rays && HitSpline::serves(sigma); }

HitGrid::HitGrid(GaussianSpot<double> const& spot)
    : spline_(spot), view_(spline_.view()), side_(side_px * view_.per_px) {
  light_.resize(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_));
  rows_seen_.resize(static_cast<std::size_t>(side_) * static_cast<std::size_t>(view_.pixels({0, side_})));
}

void HitGrid::deposit(Vec2d p, double weight, LightImage* image, double light_per_weight) {
  if (!(std::abs(p.x) < 1e7 && std::abs(p.y) < 1e7)) return;
  auto const within = [this](DealtHit const& hit) { return hit.first >= 0 && hit.first + 4 <= side_; };
  bool const untouched = columns_.high == columns_.low;
  DealtHit x((p.x - left_) * view_.per_px), y((p.y - top_) * view_.per_px);
  if (untouched || !within(x) || !within(y)) {
    if (!untouched) flush(image, light_per_weight);
    left_ = static_cast<int>(std::floor(p.x)) - side_px / 2;
    top_ = static_cast<int>(std::floor(p.y)) - side_px / 2;
    columns_ = lines_ = {side_, 0};
    x = DealtHit((p.x - left_) * view_.per_px);
    y = DealtHit((p.y - top_) * view_.per_px);
  }
  columns_ = {std::min(columns_.low, x.first), std::max(columns_.high, x.first + 4)};
  lines_ = {std::min(lines_.low, y.first), std::max(lines_.high, y.first + 4)};
  double* line = light_.data() + y.first * side_ + x.first;
  for (int j = 0; j < 4; ++j, line += side_) {
    double const share = weight * y.share[j];
    for (int i = 0; i < 4; ++i) line[i] += share * x.share[i];
  }
}

void HitGrid::flush(LightImage* image, double light_per_weight) {
  if (columns_.high == columns_.low) return;
  if (image) {
    blur_hits(
        OneLane(), view_, columns_, lines_, light_.data(), side_, rows_seen_.data(),
        [&](int column, int row, double light) { image->add(left_ + column, top_ + row, light * light_per_weight); });
  }
  for (int line = lines_.low; line < lines_.high; ++line) {
    auto const from = light_.begin() + line * side_;
    std::fill(from + columns_.low, from + columns_.high, 0.0);
  }
  columns_ = lines_ = {0, 0};
}

}  // namespace gladstone
