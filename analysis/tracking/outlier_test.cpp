#include "analysis/tracking/outlier_test.h"

#include "analysis/correlation/vector_validation.h"
#include "analysis/tracking/nearest_points.h"
#include "render/base/contracts.h"
#include "render/base/not_a_number.h"
#include "render/base/parallel.h"

namespace gladstone::inline tracking {

std::vector<char> find_outliers(std::span<Vec2d const> positions, std::span<Vec2d const> values,
                                OutlierTest const& test) {
  GLADSTONE_EXPECTS(positions.size() == values.size());
  std::vector<Vec2d> usable(positions.begin(), positions.end());
  for (std::size_t i = 0; i < usable.size(); ++i)
    if (!is_finite(values[i])) usable[i] = {not_a_number, not_a_number};
  NearestPoints const cells(usable);
  std::vector<char> outlier(positions.size());
  parallel_chunks(positions.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      if (!is_finite(usable[i])) continue;
      Neighbours<double> neighbours;
      for (std::size_t const k : cells.nearest(usable[i], Neighbours<double>::capacity + 1, 8 * cells.spacing()))
        if (k != i && neighbours.count < Neighbours<double>::capacity) neighbours.append(values[k]);
      outlier[i] = neighbours.count >= fewest_neighbours &&
                   normalised_median_residual(values[i], neighbours, test.epsilon_px, test.threshold) > test.threshold;
    }
  });
  return outlier;
}

}  // namespace gladstone::inline tracking
