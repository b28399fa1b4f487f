#include "analysis/correlation/optical_flow/dense_flow.h"

#include <algorithm>
#include <cmath>

#include "render/base/parallel.h"

namespace gladstone::inline correlation {
namespace {

constexpr std::size_t rows_at_once = 16;

/// Filters an image along both axes and samples it at every `step`-th pixel.
/// @param weight  weights of the symmetric kernel at offsets 0, 1, 2, ...
GreyImage filtered(GreyImage const& image, std::vector<float> const& weight, int step) {
  int const reach = static_cast<int>(weight.size()) - 1;
  GreyImage across{(image.columns + step - 1) / step, image.rows, {}};
  across.level.resize(static_cast<std::size_t>(across.columns) * across.rows);
  parallel_chunks(static_cast<std::size_t>(across.rows), rows_at_once, [&](std::size_t begin, std::size_t end) {
    for (int j = static_cast<int>(begin); j < static_cast<int>(end); ++j)
      for (int i = 0; i < across.columns; ++i) {
        float sum = weight[0] * image(i * step, j);
        for (int k = 1; k <= reach; ++k) sum += weight[k] * (image(i * step - k, j) + image(i * step + k, j));
        across.level[static_cast<std::size_t>(j) * across.columns + i] = sum;
      }
  });
  GreyImage result{across.columns, (image.rows + step - 1) / step, {}};
  result.level.resize(static_cast<std::size_t>(result.columns) * result.rows);
  parallel_chunks(static_cast<std::size_t>(result.rows), rows_at_once, [&](std::size_t begin, std::size_t end) {
    for (int j = static_cast<int>(begin); j < static_cast<int>(end); ++j)
      for (int i = 0; i < result.columns; ++i) {
        float sum = weight[0] * across(i, j * step);
        for (int k = 1; k <= reach; ++k) sum += weight[k] * (across(i, j * step - k) + across(i, j * step + k));
        result.level[static_cast<std::size_t>(j) * result.columns + i] = sum;
      }
  });
  return result;
}

}  // namespace

Vec2d DenseFlow::at(Vec2d position) const {
  double const x = std::clamp(position.x, 0.0, columns - 1.0), y = std::clamp(position.y, 0.0, rows - 1.0);
  int const i = std::min(static_cast<int>(x), std::max(0, columns - 2));
  int const j = std::min(static_cast<int>(y), std::max(0, rows - 2));
  int const right = std::min(i + 1, columns - 1), below = std::min(j + 1, rows - 1);
  double const fx = x - i, fy = y - j;
  auto const blend = [&](std::vector<float> const& of) {
    return (1.0 - fy) * ((1.0 - fx) * of[index(i, j)] + fx * of[index(right, j)]) +
           fy * ((1.0 - fx) * of[index(i, below)] + fx * of[index(right, below)]);
  };
  return {blend(u), blend(v)};
}

DenseFlow DenseFlow::finer(int width, int height) const {
  DenseFlow fine(width, height);
  for (int j = 0; j < height; ++j)
    for (int i = 0; i < width; ++i) {
      Vec2d const twice = 2.0 * at({0.5 * i, 0.5 * j});
      fine.u[fine.index(i, j)] = static_cast<float>(twice.x);
      fine.v[fine.index(i, j)] = static_cast<float>(twice.y);
    }
  return fine;
}

std::vector<GreyImage> build_pyramid(GreyImage finest) {
  constexpr int least_side = 24;
  std::vector<GreyImage> levels;
  levels.push_back(std::move(finest));
  while (std::min(levels.back().columns, levels.back().rows) >= 2 * least_side)
    levels.push_back(filtered(levels.back(), {6.0f / 16.0f, 4.0f / 16.0f, 1.0f / 16.0f}, 2));
  return levels;
}

GreyImage normalised_frame(GreyImage frame) {
  constexpr double reach_px = 8.0;
  std::vector<float> weight;
  double all = 0.0;
  for (int k = 0; k <= static_cast<int>(3.0 * reach_px); ++k) {
    weight.push_back(static_cast<float>(std::exp(-0.5 * k * k / (reach_px * reach_px))));
    all += (k == 0 ? 1.0 : 2.0) * weight.back();
  }
  for (float& w : weight) w = static_cast<float>(w / all);
  GreyImage const mean = filtered(frame, weight, 1);
  double squares = 0.0;
  for (std::size_t i = 0; i < frame.level.size(); ++i) {
    frame.level[i] -= mean.level[i];
    squares += static_cast<double>(frame.level[i]) * frame.level[i];
  }
  double const rms = std::sqrt(squares / static_cast<double>(frame.level.size()));
  if (rms > 0.0)
    for (float& value : frame.level) value = static_cast<float>(value / rms);
  return frame;
}

GreyRange joint_range(GreyImage const& reference, GreyImage const& flow) {
  std::vector<float> levels(reference.level);
  levels.insert(levels.end(), flow.level.begin(), flow.level.end());
  if (levels.empty()) return {};
  GreyRange range;
  range.low = *std::min_element(levels.begin(), levels.end());
  auto const high = levels.end() - 1 - static_cast<std::ptrdiff_t>(levels.size() / brightest_pixels);
  std::nth_element(levels.begin(), high, levels.end());
  range.high = *high;
  // In frames with fewer bright pixels than this fraction, use the full range.
  if (!(range.high > range.low)) range.high = *std::max_element(levels.begin(), levels.end());
  return range;
}

}  // namespace gladstone::inline correlation
