#include "analysis/correlation/window_means.h"

#include "analysis/correlation/float_lanes.h"
#include "render/base/parallel.h"

namespace gladstone::inline correlation {
namespace {

/// Adds weight * value[i] to sum[i]. @pre count is a multiple of lane_count
void add_row(float weight, float const* value, float* sum, int count) {
  for (int i = 0; i < count; i += lane_count)
    store_lanes(sum + i, load_lanes(sum + i) + weight * load_lanes(value + i));
}

float weighted_sum(float const* weight, float const* value, int count) {
  FloatLanes sum{};
  int i = 0;
  for (; i + lane_count <= count; i += lane_count) sum += load_lanes(weight + i) * load_lanes(value + i);
  float rest = 0.0f;
  for (; i < count; ++i) rest += weight[i] * value[i];
  return sum_of_lanes(sum) + rest;
}

}  // namespace

WindowMeans::WindowMeans(InterrogationJob const& job, AxisWeightsView const& x, AxisWeightsView const& y)
    : columns_(job.grid.columns), means_(job.grid.size()) {
  ImagePair const& pair = job.pair;
  int const side = window_side_px(job.weighting, job.grid.window_px), offset = (x.size - side) / 2;
  int const whole = pair.columns / lane_count * lane_count;
  auto const add = [&](UninitializedVector<float> const& image, int row, float weight, std::vector<float>& sums) {
    float const* const value = image.data() + static_cast<std::size_t>(row) * pair.columns;
    add_row(weight, value, sums.data(), whole);
    for (int i = whole; i < pair.columns; ++i) sums[static_cast<std::size_t>(i)] += weight * value[i];
  };
  parallel_chunks(static_cast<std::size_t>(job.grid.rows), 1, [&](std::size_t begin, std::size_t) {
    int const row = static_cast<int>(begin), first_y = y.first(row) + offset;
    if (first_y < 0 || first_y + side > pair.rows) return;
    std::vector<float> reference(static_cast<std::size_t>(pair.columns)), flow(reference);
    for (int j = 0; j < side; ++j) {
      float const weight = y.weight(row)[offset + j];
      add(pair.reference, first_y + j, weight, reference);
      add(pair.flow, first_y + j, weight, flow);
    }
    for (int column = 0; column < columns_; ++column) {
      int const first_x = x.first(column) + offset;
      if (first_x < 0 || first_x + side > pair.columns) continue;
      float const* const weight = x.weight(column) + offset;
      float const all = static_cast<float>(x.sum(column) * y.sum(row));
      means_[static_cast<std::size_t>(row) * columns_ + column] = {
          weighted_sum(weight, reference.data() + first_x, side) / all,
          weighted_sum(weight, flow.data() + first_x, side) / all};
    }
  });
}

}  // namespace gladstone::inline correlation
