#pragma once

#include <algorithm>
#include <cstddef>

#include "analysis/correlation/axis_weights.h"
#include "analysis/correlation/window_deformation.h"

namespace gladstone::inline correlation {

/// Calls visit(i, j, weight, at) for every pixel (i, j) of a window's support that is inside the image, row by row;
/// `at` is the index of the pixel in the frames. The weight is 0 for pixels that are unknown in one of the frames.
/// @param column,  row  position of the window in the grid
template <class Visit>
void visit_window_pixels(ImagePair const& pair, AxisWeightsView const& x, int column, AxisWeightsView const& y, int row,
                         Visit const& visit) {
  int const first_x = x.first(column), first_y = y.first(row);
  int const end_x = std::min(x.size, pair.columns - first_x), end_y = std::min(y.size, pair.rows - first_y);
  for (int j = std::max(0, -first_y); j < end_y; ++j)
    for (int i = std::max(0, -first_x); i < end_x; ++i) {
      std::size_t const at = static_cast<std::size_t>(first_y + j) * pair.columns + (first_x + i);
      float const known = pair.available.empty() ? 1.0f : pair.available[at];
      visit(i, j, x.weight(column)[i] * y.weight(row)[j] * known, at);
    }
}

}  // namespace gladstone::inline correlation
