#include "analysis/uncertainty/matched_windows.h"

#include <algorithm>
#include <cmath>

#include "analysis/correlation/standard_correlator.h"
#include "analysis/uncertainty/neighbour_mean.h"
#include "render/base/parallel.h"

namespace gladstone::inline uncertainty {
namespace {

constexpr std::size_t matches_per_piece = 64;

void take_window(ImagePair const& pair, int first_x, int first_y, std::vector<float> const& axis,
                 MatchedWindow& window) {
  std::fill(window.weight.begin(), window.weight.end(), 0.0f);
  std::fill(window.reference.begin(), window.reference.end(), 0.0f);
  std::fill(window.flow.begin(), window.flow.end(), 0.0f);
  int const begin_x = std::max(0, -first_x), end_x = std::min(window.side, pair.columns - first_x);
  int const begin_y = std::max(0, -first_y), end_y = std::min(window.side, pair.rows - first_y);
  double weights = 0.0, reference = 0.0, flow = 0.0;
  for (int j = begin_y; j < end_y; ++j)
    for (int i = begin_x; i < end_x; ++i) {
      std::size_t const from = static_cast<std::size_t>(first_y + j) * pair.columns + (first_x + i);
      std::size_t const to = window.at(i, j);
      float const known = pair.available.empty() ? 1.0f : pair.available[from];
      float const w = axis[static_cast<std::size_t>(i)] * axis[static_cast<std::size_t>(j)] * known;
      window.weight[to] = w;
      window.reference[to] = pair.reference[from];
      window.flow[to] = pair.flow[from];
      weights += w;
      reference += static_cast<double>(w) * pair.reference[from];
      flow += static_cast<double>(w) * pair.flow[from];
    }
  float const mean_reference = weights > 0.0 ? static_cast<float>(reference / weights) : 0.0f;
  float const mean_flow = weights > 0.0 ? static_cast<float>(flow / weights) : 0.0f;
  double energy_reference = 0.0, energy_flow = 0.0;
  for (std::size_t k = 0; k < window.weight.size(); ++k) {
    float const w = window.weight[k];
    window.reference[k] = w > 0.0f ? window.reference[k] - mean_reference : 0.0f;
    window.flow[k] = w > 0.0f ? window.flow[k] - mean_flow : 0.0f;
    energy_reference += static_cast<double>(w * window.reference[k]) * (w * window.reference[k]);
    energy_flow += static_cast<double>(w * window.flow[k]) * (w * window.flow[k]);
  }
  // Illumination differences between the frames do not count as differences of the pattern.
  if (!(energy_flow > 0.0)) return;
  float const gain = static_cast<float>(std::sqrt(energy_reference / energy_flow));
  for (float& value : window.flow) value *= gain;
}

}  // namespace

WindowShape window_shape(CorrelationSettings const& settings, InterrogationGrid const& grid) {
  constexpr std::size_t together = 8;
  WindowWeighting const weighting = window_weighting(settings);
  int const side = window_side_px(weighting, grid.window_px);
  WindowShape shape{side, std::vector<float>((static_cast<std::size_t>(side) + together - 1) / together * together)};
  for (int i = 0; i < side; ++i)
    shape.axis[static_cast<std::size_t>(i)] =
        static_cast<float>(axis_weight(weighting, i - 0.5 * (side - 1), static_cast<double>(grid.window_px)));
  return shape;
}

Vec2<int> first_pixel(InterrogationGrid const& grid, std::size_t vector, int side) {
  Vec2d const centre = grid.centre(vector);
  return {static_cast<int>(std::lround(centre.x - 0.5 * (side - 1))),
          static_cast<int>(std::lround(centre.y - 0.5 * (side - 1)))};
}

void visit_matched_windows(UncertaintyInput const& input,
                           std::function<void(std::size_t, MatchedWindow const&)> const& visit) {
  WindowShape const shape = window_shape(input.settings, input.grid);
  parallel_chunks(input.field.size(), matches_per_piece, [&](std::size_t begin, std::size_t end) {
    std::size_t const pixels = static_cast<std::size_t>(shape.side) * shape.side;
    MatchedWindow window{shape.side, std::vector<float>(pixels), std::vector<float>(pixels),
                         std::vector<float>(pixels)};
    for (std::size_t i = begin; i < end; ++i) {
      if (input.field.status[i] != VectorStatus::valid) continue;
      Vec2<int> const first = first_pixel(input.grid, i, shape.side);
      take_window(input.matched, first.x, first.y, shape.axis, window);
      visit(i, window);
    }
  });
}

std::vector<double> averaged_over_neighbours(std::vector<double> const& values, InterrogationGrid const& grid) {
  std::vector<double> result(values.size());
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column)
      result[static_cast<std::size_t>(row) * grid.columns + column] =
          mean_of_neighbours(column, row, grid.columns, grid.rows,
                             [&](int x, int y) { return values[static_cast<std::size_t>(y) * grid.columns + x]; });
  return result;
}

std::vector<Vec2d> sigma_of_variances(std::vector<double> const& u, std::vector<double> const& v,
                                      InterrogationGrid const& grid) {
  std::vector<double> const along_x = averaged_over_neighbours(u, grid), along_y = averaged_over_neighbours(v, grid);
  std::vector<Vec2d> sigma(u.size());
  for (std::size_t i = 0; i < sigma.size(); ++i) sigma[i] = {std::sqrt(along_x[i]), std::sqrt(along_y[i])};
  return sigma;
}

}  // namespace gladstone::inline uncertainty
