#include "render/scene/dot_exposure.h"

#include <cmath>
#include <limits>

namespace gladstone {

SpotView make_spot(Scene const& scene, std::optional<AiryTable>& airy) {
  SpotView spot;
  spot.model = scene.chief_rays_only() ? SpotModel::none : scene.setup.lens.spot;
  if (spot.model == SpotModel::airy) spot.airy = airy.emplace(scene.spot_scale_px()).view();
  spot.gaussian.sigma = scene.spot_sigma_px();
  return spot;
}

LightPatch::LightPatch(SpotView const& spot)
    : spot_(spot),
      half_(spot.half_width()),
      side_(2 * half_ + 33),
      light_(static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_), 0.0),
      column_shares_(static_cast<std::size_t>(2 * half_ + 1)),
      row_shares_(static_cast<std::size_t>(2 * half_ + 1)) {}

void LightPatch::deposit(Vec2d p, double weight, LightImage* image, double light_per_weight) {
  double const middle_x = std::floor(p.x + 0.5), middle_y = std::floor(p.y + 0.5);
  if (!(std::abs(middle_x) < 1e8 && std::abs(middle_y) < 1e8)) return;
  int const width = 2 * half_ + 1;
  int const column = static_cast<int>(middle_x) - half_, row = static_cast<int>(middle_y) - half_;
  bool const untouched = high_column_ == low_column_;
  if (untouched || column < left_ || row < top_ || column + width > left_ + side_ || row + width > top_ + side_) {
    if (!untouched) flush(image, light_per_weight);
    left_ = column - (side_ - width) / 2;
    top_ = row - (side_ - width) / 2;
    low_column_ = low_row_ = side_;
    high_column_ = high_row_ = 0;
  }
  int const c0 = column - left_, r0 = row - top_;
  low_column_ = std::min(low_column_, c0);
  high_column_ = std::max(high_column_, c0 + width);
  low_row_ = std::min(low_row_, r0);
  high_row_ = std::max(high_row_, r0 + width);
  double* const corner = light_.data() + r0 * side_ + c0;

  switch (spot_.model) {
    case SpotModel::none: *corner += weight; break;
    case SpotModel::airy: {
      AiryTable::View const& table = spot_.airy;
      double const u = (p.x - middle_x + 0.5) * table.subdivisions, v = (p.y - middle_y + 0.5) * table.subdivisions;
      int const iu = std::min(static_cast<int>(u), table.subdivisions - 1);
      int const iv = std::min(static_cast<int>(v), table.subdivisions - 1);
      double const fu = u - iu, fv = v - iv;
      std::ptrdiff_t const footprint = static_cast<std::ptrdiff_t>(width) * width;
      double const* const lower = table.shares + (static_cast<std::ptrdiff_t>(iv) * (table.subdivisions + 1) + iu) * footprint;
      double const* const upper = lower + (table.subdivisions + 1) * footprint;
      for (int j = 0; j < width; ++j) {
        for (int i = 0; i < width; ++i) {
          std::ptrdiff_t const at = static_cast<std::ptrdiff_t>(j) * width + i;
          double const low = lower[at] + fu * (lower[at + footprint] - lower[at]);
          double const high = upper[at] + fu * (upper[at + footprint] - upper[at]);
          corner[j * side_ + i] += weight * (low + fv * (high - low));
        }
      }
      break;
    }
    default: {
      spot_.gaussian.shares(p.x, column, width, column_shares_.data());
      spot_.gaussian.shares(p.y, row, width, row_shares_.data());
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

void DotExposure::finish(GroundTruth& truth, std::size_t dot) {
  constexpr double nan = std::numeric_limits<double>::quiet_NaN();
  if (with_image_) {
    for (int frame = 0; frame < frame_count; ++frame) {
      patches_[static_cast<std::size_t>(frame)].flush(images_[frame], light_per_weight_);
    }
  }
  bool const seen[2] = {sums_[0].weight > 0, sums_[1].weight > 0};
  Vec2d const none{nan, nan};
  truth.reference_px[dot] = seen[0] ? origin_ + sums_[0].mean() : none;
  truth.displacement_px[dot] = seen[0] && seen[1] ? sums_[1].mean() - sums_[0].mean() : none;
  truth.displacement_std_px[dot] = seen[1] ? sums_[1].deviation() : none;
  truth.flux[dot] = {sums_[0].weight * light_per_weight_, sums_[1].weight * light_per_weight_};
  truth.rays[dot] = {sums_[0].count, sums_[1].count};
}

}  // namespace gladstone
