#include "render/scene/light_patch.h"

#include <algorithm>
#include <cmath>

namespace gladstone::inline scene {
namespace {

/// Returns the pixels that a PSF centred at p covers.
/// @pre p is within the range of int
Footprint footprint(Vec2d p, int half) {
  return {static_cast<int>(std::floor(p.x + 0.5)) - half, static_cast<int>(std::floor(p.y + 0.5)) - half, 2 * half + 1};
}

}  // namespace

LightPatch::LightPatch(SpotView const& spot, int half)
    : spot_(spot),
      half_(spot.half_width()),
      side_(2 * std::max(half_, half) + 33),
      light_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), 0.0),
      column_shares_(static_cast<std::size_t>(2 * half_ + 1)),
      row_shares_(column_shares_.size()) {}

double* LightPatch::reach(Footprint const& spot, LightImage* image, double light_per_weight) {
  int const width = spot.width;
  bool const untouched = high_column_ == low_column_;
  if (untouched || spot.column < left_ || spot.row < top_ || spot.column + width > left_ + side_ ||
      spot.row + width > top_ + side_) {
    if (!untouched) flush(image, light_per_weight);
    left_ = spot.column - (side_ - width) / 2;
    top_ = spot.row - (side_ - width) / 2;
    low_column_ = low_row_ = side_;
    high_column_ = high_row_ = 0;
  }
  int const c0 = spot.column - left_, r0 = spot.row - top_;
  low_column_ = std::min(low_column_, c0);
  high_column_ = std::max(high_column_, c0 + width);
  low_row_ = std::min(low_row_, r0);
  high_row_ = std::max(high_row_, r0 + width);
  return light_.data() + r0 * side_ + c0;
}

void LightPatch::deposit(Vec2d p, double weight, LightImage* image, double light_per_weight) {
  if (!(std::abs(p.x) < 1e8 && std::abs(p.y) < 1e8)) return;
  Footprint const spot = footprint(p, half_);
  double* const corner = reach(spot, image, light_per_weight);
  int const width = spot.width;
  switch (spot_.model) {
    case SpotModel::none:
      *corner += weight;
      break;
    case SpotModel::airy:
      for (int j = 0; j < width; ++j) {
        for (int i = 0; i < width; ++i) {
          corner[j * side_ + i] +=
              weight * spot_.airy.share(p.x - (spot.column + half_), p.y - (spot.row + half_), j, i);
        }
      }
      break;
    default: {
      spot_.gaussian.shares(p.x, spot.column, width, column_shares_.data());
      spot_.gaussian.shares(p.y, spot.row, width, row_shares_.data());
      for (int j = 0; j < width; ++j) {
        double const line = weight * row_shares_[static_cast<std::size_t>(j)];
        for (int i = 0; i < width; ++i) corner[j * side_ + i] += line * column_shares_[static_cast<std::size_t>(i)];
      }
    }
  }
}

void LightPatch::flush(LightImage* image, double light_per_weight) {
  for (int row = low_row_; row < high_row_; ++row) {
    double* const line = light_.data() + row * side_;
    for (int column = low_column_; column < high_column_; ++column) {
      if (image && line[column] != 0) image->add(column + left_, row + top_, line[column] * light_per_weight);
      line[column] = 0;
    }
  }
  low_column_ = high_column_ = low_row_ = high_row_ = 0;
}

}  // namespace gladstone::inline scene
