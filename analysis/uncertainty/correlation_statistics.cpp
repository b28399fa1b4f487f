#include <cmath>
#include <limits>

#include "analysis/uncertainty/eight_columns.h"
#include "analysis/uncertainty/matched_windows.h"
#include "analysis/uncertainty/pass_amplification.h"
#include "analysis/uncertainty/window_statistics.h"
#include "render/base/parallel.h"

namespace gladstone::inline uncertainty {
namespace {

constexpr std::size_t windows_per_piece = 64;

/// Access to the pixels of a window, eight pixels of a row at a time.
struct LanePixels {
  ImagePair const& pair;
  float scale;                     ///< factor by which grey levels are multiplied
  std::vector<float> const& axis;  ///< weights along either axis, followed by zeros up to a multiple of eight
  int first_x, first_y;            ///< image position of the window's first pixel

  MatchedPixels<FloatLanes> at(int x, int row) const {
    int const column = first_x + x, image_row = first_y + row;
    if (image_row < 0 || image_row >= pair.rows) return MatchedPixels<FloatLanes>{};
    FloatLanes const weight = axis[static_cast<std::size_t>(row)] * load_lanes(axis.data() + x);
    long long const from = static_cast<long long>(image_row) * pair.columns + column;
    if (column < 0 || column + lane_count > pair.columns) return cut_off(column, from, weight);
    FloatLanes const known = pair.available.empty() ? all_lanes(1.0f) : load_lanes(pair.available.data() + from);
    return {weight * known, scale * load_lanes(pair.reference.data() + from),
            scale * load_lanes(pair.flow.data() + from)};
  }

 private:
  /// Returns eight pixels some of which are outside the image; these have the weight 0.
  MatchedPixels<FloatLanes> cut_off(int column, long long from, FloatLanes weight) const {
    MatchedPixels<FloatLanes> pixels{};
    for (int l = 0; l < lane_count; ++l) {
      if (column + l < 0 || column + l >= pair.columns) continue;
      auto const k = static_cast<std::size_t>(from + l);
      pixels.weight[l] = weight[l] * (pair.available.empty() ? 1.0f : pair.available[k]);
      pixels.reference[l] = scale * pair.reference[k];
      pixels.flow[l] = scale * pair.flow[k];
    }
    return pixels;
  }
};

/// Computes the sums over one window. @param memory  scratch memory of WindowStatistics::values(side) floats
StatisticsSums sums_of_window(LanePixels const& pixels, int side, std::vector<float>& memory) {
  WindowStatistics<EightColumns> const window{memory.data(), side, 0, 1};
  window.clear();
  WindowSums<double> const light = window.sum_pixels(pixels);
  if (!(light.weight > 0.0)) return {};
  WindowLevels const means = weighted_means(light), levels = equally_bright(means, window.sum_squares(pixels, means));
  StatisticsSums sums;
  for (int n = 0; n < window.steps(side); ++n) window.step(n, pixels, levels, sums);
  return sums;
}

/// Returns a power of two that scales grey levels to about 1, so that their fourth powers do not overflow.
float scale_of(float contrast) { return contrast > 0.0f ? std::ldexp(1.0f, -std::ilogb(contrast)) : 1.0f; }

}  // namespace

std::vector<Vec2d> correlation_statistics(UncertaintyInput const& input) {
  double const amplification = amplification_of_passes(input.settings), squared = amplification * amplification;
  WindowShape const shape = window_shape(input.settings, input.grid);
  float const scale = scale_of(input.matched.contrast);
  std::vector<double> u(input.field.size(), std::numeric_limits<double>::quiet_NaN()), v = u;
  parallel_chunks(u.size(), windows_per_piece, [&](std::size_t begin, std::size_t end) {
    std::vector<float> memory(static_cast<std::size_t>(WindowStatistics<EightColumns>::values(shape.side)));
    for (std::size_t i = begin; i < end; ++i) {
      if (input.field.status[i] != VectorStatus::valid) continue;
      Vec2<int> const first = first_pixel(input.grid, i, shape.side);
      StatisticsSums const sums =
          sums_of_window({input.matched, scale, shape.axis, first.x, first.y}, shape.side, memory);
      u[i] = squared * displacement_variance(sums, 0);
      v[i] = squared * displacement_variance(sums, 1);
    }
  });
  return sigma_of_variances(u, v, input.grid);
}

}  // namespace gladstone::inline uncertainty
