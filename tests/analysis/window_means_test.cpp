#include "analysis/correlation/window_means.h"

#include <gtest/gtest.h>

#include <cmath>

namespace gladstone {
namespace {

// The definition, summed in double precision. Levels up to 100 are summed in float, first down a column of up to 48
// pixels, then along x: random errors of 6e-8 of 100 for each of some tens of partial sums add up to 4e-5.
TEST(WindowMeans, AreTheWeightedMeansOfWindowsInsideTheFrames) {
  constexpr int columns = 101, rows = 83;
  ImagePair pair;
  pair.columns = columns;
  pair.rows = rows;
  for (int j = 0; j < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      pair.reference.push_back(static_cast<float>(100.0 * std::sin(0.3 * i + 0.7 * j)));
      pair.flow.push_back(static_cast<float>(0.9 * i - 0.4 * j));
    }
  for (WindowWeighting const weighting : {WindowWeighting::gaussian, WindowWeighting::uniform}) {
    InterrogationGrid const grid = make_interrogation_grid(columns, rows, 24, 0.7);
    AxisWeights const x(grid, GridAxis::x, columns, weighting), y(grid, GridAxis::y, rows, weighting);
    InterrogationJob const job{.pair = pair, .grid = grid, .weighting = weighting};
    WindowMeans const means(job, x.view(), y.view());
    int compared = 0;
    for (int row = 0; row < grid.rows; ++row)
      for (int column = 0; column < grid.columns; ++column) {
        double all = 0.0, reference = 0.0, flow = 0.0;
        bool inside = true;
        for (int j = 0; j < x.view().size; ++j)
          for (int i = 0; i < x.view().size; ++i) {
            double const offset_x = i - 0.5 * (x.view().size - 1), offset_y = j - 0.5 * (x.view().size - 1);
            double const w = axis_weight(weighting, offset_x, 24.0) * axis_weight(weighting, offset_y, 24.0);
            int const at_x = x.view().first(column) + i, at_y = y.view().first(row) + j;
            if (w == 0.0) continue;
            inside = inside && at_x >= 0 && at_y >= 0 && at_x < columns && at_y < rows;
            if (!inside) continue;
            std::size_t const at = static_cast<std::size_t>(at_y) * columns + at_x;
            all += w;
            reference += w * pair.reference[at];
            flow += w * pair.flow[at];
          }
        if (!inside) continue;
        ++compared;
        EXPECT_NEAR(means.of(column, row).x, reference / all, 4e-5);
        EXPECT_NEAR(means.of(column, row).y, flow / all, 4e-5);
      }
    EXPECT_GT(compared, 30);
  }
}

}  // namespace
}  // namespace gladstone
