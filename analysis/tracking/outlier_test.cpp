#include "analysis/tracking/outlier_test.h"

#include <algorithm>
#include <cmath>

#include "analysis/tracking/nearest_points.h"
#include "render/base/contracts.h"
#include "render/base/not_a_number.h"
#include "render/base/parallel.h"

namespace gladstone::tracking {
namespace {

double sorted_median(std::vector<double>& values) {
  std::sort(values.begin(), values.end());
  std::size_t const half = values.size() / 2;
  return values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
}

/// Returns the distance of a value from the neighbours' median over their median distance from it plus epsilon.
double normalised_residual(double value, std::vector<double> neighbours, double epsilon) {
  double const median = sorted_median(neighbours);
  for (double& neighbour : neighbours) neighbour = std::abs(neighbour - median);
  return std::abs(value - median) / (sorted_median(neighbours) + epsilon);
}

}  // namespace

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
      std::vector<double> x, y;
      for (std::size_t const k : cells.nearest(usable[i], test.neighbours + 1, 8 * cells.spacing())) {
        if (k == i) continue;
        x.push_back(values[k].x);
        y.push_back(values[k].y);
      }
      if (x.size() < 3) continue;
      outlier[i] = normalised_residual(values[i].x, x, test.epsilon_px) > test.threshold ||
                   normalised_residual(values[i].y, y, test.epsilon_px) > test.threshold;
    }
  });
  return outlier;
}

}  // namespace gladstone::tracking
