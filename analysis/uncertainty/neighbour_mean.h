#pragma once

#include "render/base/host_device.h"

namespace gladstone::inline uncertainty {

/// Returns the mean of the known values in the 3 x 3 neighbourhood of a grid position. Averaging reduces the scatter of
/// variances that are estimated from a few particles.
/// @param value  value(column, row), NaN: unknown
/// @return NaN if the value at (column, row) itself is unknown
template <class Value>
GLADSTONE_HD double mean_of_neighbours(int column, int row, int columns, int rows, Value const& value) {
  double const own = value(column, row);
  if (own != own) return own;
  double sum = 0.0, count = 0.0;
  for (int y = row > 0 ? row - 1 : 0; y <= row + 1 && y < rows; ++y)
    for (int x = column > 0 ? column - 1 : 0; x <= column + 1 && x < columns; ++x) {
      double const beside = value(x, y);
      if (beside != beside) continue;
      sum += beside;
      count += 1.0;
    }
  return sum / count;
}

}  // namespace gladstone::inline uncertainty
