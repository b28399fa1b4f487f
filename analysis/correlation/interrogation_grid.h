#pragma once

#include <cmath>
#include <cstddef>

#include "render/base/contracts.h"
#include "render/base/host_device.h"
#include "render/base/vec.h"

namespace gladstone {

/// Along the columns of an image (x), or along its rows (y).
enum class GridAxis { x, y };

/// Where the interrogation windows of one pass lie: square windows of nominal size window_px, every one inside the
/// image. Vector i stands at column i % columns, row i / columns.
struct InterrogationGrid {
  int window_px = 0;   ///< nominal window size
  int spacing_px = 1;  ///< distance of neighbouring windows
  int columns = 0;     ///< windows in a row; 0 where the image is smaller than a window
  int rows = 0;
  int first_x_px = 0;  ///< image column where the first window begins
  int first_y_px = 0;  ///< image row where the first window begins

  GLADSTONE_HD std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  GLADSTONE_HD int windows(GridAxis axis) const { return axis == GridAxis::x ? columns : rows; }
  GLADSTONE_HD int first_px(GridAxis axis) const { return axis == GridAxis::x ? first_x_px : first_y_px; }
  /// Centre of the windows of grid column (or row) `index` along its axis [px]: (window_px - 1)/2 from the window's
  /// first pixel, hence half-integer for the even windows we use.
  GLADSTONE_HD double centre(GridAxis axis, int index) const {
    return first_px(axis) + 0.5 * (window_px - 1) + static_cast<double>(index) * spacing_px;
  }
  GLADSTONE_HD Vec2d centre(std::size_t vector) const {
    return {centre(GridAxis::x, static_cast<int>(vector % static_cast<std::size_t>(columns))),
            centre(GridAxis::y, static_cast<int>(vector / static_cast<std::size_t>(columns)))};
  }

  /// Columns (or rows) first .. last of a grid.
  struct Range {
    int first, last;
  };
  /// The columns (or rows) whose windows' centres are nearest to a place: one, or two that are equally near.
  /// @pre size() > 0
  GLADSTONE_HD Range nearest(GridAxis axis, double position_px) const {
    using std::ceil;
    using std::floor;
    double const node = (position_px - centre(axis, 0)) / spacing_px;
    int const last = windows(axis) - 1, low = static_cast<int>(ceil(node - 0.5)),
              high = static_cast<int>(floor(node + 0.5));
    return {low < 0 ? 0 : (low < last ? low : last), high < 0 ? 0 : (high < last ? high : last)};
  }
};

/// Distance of neighbouring windows [px], whole.
inline int grid_spacing_px(int window_px, double overlap) {
  int const spacing = static_cast<int>(std::lround(window_px * (1.0 - overlap)));
  return spacing > 1 ? spacing : 1;
}

/// The grid of the vectors on an image of the given size: the first window on pixels 0 .. window_px - 1 of either axis.
/// @param overlap fraction of a window that it shares with the next, [0, 1); the spacing is rounded to whole pixels
inline InterrogationGrid make_interrogation_grid(int image_columns, int image_rows, int window_px, double overlap) {
  GLADSTONE_EXPECTS(window_px > 0 && overlap >= 0.0 && overlap < 1.0);
  InterrogationGrid grid;
  grid.window_px = window_px;
  grid.spacing_px = grid_spacing_px(window_px, overlap);
  grid.columns = image_columns < window_px ? 0 : (image_columns - window_px) / grid.spacing_px + 1;
  grid.rows = image_rows < window_px ? 0 : (image_rows - window_px) / grid.spacing_px + 1;
  if (grid.columns == 0 || grid.rows == 0) grid.columns = grid.rows = 0;
  return grid;
}

/// The same with as much of the image on the left as on the right, and above as below, so that a mirrored image has the
/// mirrored windows. They begin at whole pixels, and what they leave over must be an even number of them: along an axis
/// where it is odd there is one window less, or the spacing is smaller by one pixel on both. Of one window alone the
/// middle may still be half a pixel off.
inline InterrogationGrid make_centred_grid(int image_columns, int image_rows, int window_px, double overlap) {
  InterrogationGrid grid = make_interrogation_grid(image_columns, image_rows, window_px, overlap);
  if (grid.size() == 0) return grid;
  int const room_x = image_columns - window_px, room_y = image_rows - window_px;
  bool const any_odd = room_x % 2 != 0 || room_y % 2 != 0;
  if (any_odd && grid.spacing_px % 2 == 0) --grid.spacing_px;
  auto const place = [&](int room, int& windows, int& first) {
    windows = room / grid.spacing_px + 1;
    if ((room - (windows - 1) * grid.spacing_px) % 2 != 0 && windows > 1) --windows;
    first = (room - (windows - 1) * grid.spacing_px) / 2;
  };
  place(room_x, grid.columns, grid.first_x_px);
  place(room_y, grid.rows, grid.first_y_px);
  return grid;
}

}  // namespace gladstone
