#pragma once

#include <cmath>

#include "analysis/correlation/peak_search.h"
#include "analysis/correlation/window_ops.h"
#include "cuda/correlation/small_transform.h"

/// Correlation plane in the layout of a transform of two columns at a time, and its maxima.
namespace gladstone::cuda::inline correlation {

/// Correlation plane in which columns 2 i and 2 i + 1 are interleaved; pairs of columns are `pitch` apart.
template <int pitch>
struct PairedPlane {
  Complex const* centre;  ///< shifts (0, 0) and (1, 0)

  GLADSTONE_HD float operator()(int dx, int dy) const { return (&centre->re)[2 * ((dx >> 1) * pitch + dy) + (dx & 1)]; }
};

/// Two adjacent values of a row, their neighbours, and the maximum of the three values around each of them.
struct BlockRow {
  float left, first, second, right;
  float higher, around_first, around_second;

  GLADSTONE_HD BlockRow(Complex pair, Complex next)
      : left(pair.re), first(pair.im), second(next.re), right(next.im), higher(std::fmax(first, second)) {
    around_first = std::fmax(left, higher);
    around_second = std::fmax(higher, right);
  }
  /// Return true if the first or second value is a maximum, given the rows above and below. At most one of them is.
  GLADSTONE_HD bool first_is_maximum(BlockRow const& above, BlockRow const& below) const {
    return static_cast<int>(first >= second) & static_cast<int>(first > left) &
           static_cast<int>(first > above.around_first) & static_cast<int>(first >= below.around_first);
  }
  GLADSTONE_HD bool second_is_maximum(BlockRow const& above, BlockRow const& below) const {
    return static_cast<int>(second > first) & static_cast<int>(second >= right) &
           static_cast<int>(second > above.around_second) & static_cast<int>(second >= below.around_second);
  }
};

/// Blocks of two columns and four rows that cover the square |dx|, |dy| <= radius, one per thread. A half-warp
/// processes blocks of sixteen adjacent column pairs, which are in different memory banks if the pitch is odd; the
/// blocks of the seventeenth column pair follow.
/// @pre radius <= 16
struct SearchBlock {
  static constexpr int most_columns = 17, most_rows = 9;
  static constexpr int warps = (most_columns * most_rows + 31) / 32;
  int x, y;  ///< first shift of the block; beyond the radius for threads without a block

  GLADSTONE_HD SearchBlock(int thread, int radius) {
    bool const in_last = thread >= 16 * most_rows;
    x = 2 * (in_last ? most_columns - 1 : thread % 16) - (radius | 1);
    y = 4 * (in_last ? thread % 16 : thread / 16) - radius;
  }
};

/// Finds the positive maxima with |dx|, |dy| <= radius in columns x and x + 1 of rows y to y + 3. Of the four values in
/// two adjacent rows, at most one is a maximum.
/// @param found  output: maximum of rows y and y + 1, and of rows y + 2 and y + 3; height 0 if there is none
/// @pre x is odd, y >= -radius; columns x - 1 to x + 2 and rows y - 1 to y + 4 are readable
template <int pitch>
GLADSTONE_HD void maxima_of_block(PairedPlane<pitch> const& plane, int radius, int x, int y,
                                  PlanePeak<float> (&found)[2]) {
  Complex const* const pair = plane.centre + (x >> 1) * pitch + y;
  auto const row = [pair](int k) { return BlockRow(pair[k], pair[pitch + k]); };
  BlockRow above = row(-1), upper = row(0);
  for (int k = 0; k < 4; k += 2) {
    BlockRow const lower = row(k + 1), below = row(k + 2);
    bool const upper_second = upper.second_is_maximum(above, lower),
               lower_second = lower.second_is_maximum(upper, below);
    bool const in_upper = upper.first_is_maximum(above, lower) || upper_second;
    bool const in_lower = lower.first_is_maximum(upper, below) || lower_second;
    float const height = in_upper ? upper.higher : lower.higher;
    int const dx = x + (upper_second || lower_second), dy = y + k + in_lower;
    bool const counts = (in_upper || in_lower) && height > 0.0f && dx >= -radius && dx <= radius && dy <= radius;
    found[k / 2] = {dx, dy, counts ? height : 0.0f};
    above = lower;
    upper = below;
  }
}

}  // namespace gladstone::cuda::inline correlation
