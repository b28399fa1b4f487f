#pragma once

#include <cmath>
#include <cstddef>

#include "render/base/contracts.h"
#include "render/base/host_device.h"
#include "render/base/vec.h"

namespace gladstone::inline correlation {

/// Image axis: along the columns (x) or along the rows (y).
enum class GridAxis { x, y };

/// Grid of the square interrogation windows of one pass, all of them inside the image. Vector i belongs to grid column
/// i % columns and grid row i / columns.
struct InterrogationGrid {
  int window_px = 0;   ///< nominal side of a window [px]
  int spacing_px = 1;  ///< distance between the centres of neighbouring windows [px]
  int columns = 0;     ///< number of windows per row; 0 if the image is smaller than a window
  int rows = 0;
  int first_x_px = 0;  ///< image column of the first pixel of the first window
  int first_y_px = 0;  ///< image row of the first pixel of the first window

  GLADSTONE_HD std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  GLADSTONE_HD int windows(GridAxis axis) const { return axis == GridAxis::x ? columns : rows; }
  GLADSTONE_HD int first_px(GridAxis axis) const { return axis == GridAxis::x ? first_x_px : first_y_px; }
  /// Returns the centre of the windows in grid column (or row) `index` along its axis [px]: (window_px - 1)/2 from the
  /// window's first pixel, a half-integer because window sizes are even.
  GLADSTONE_HD double centre(GridAxis axis, int index) const {
    return first_px(axis) + 0.5 * (window_px - 1) + static_cast<double>(index) * spacing_px;
  }
  GLADSTONE_HD Vec2d centre(std::size_t vector) const {
    return {centre(GridAxis::x, static_cast<int>(vector % static_cast<std::size_t>(columns))),
            centre(GridAxis::y, static_cast<int>(vector / static_cast<std::size_t>(columns)))};
  }

  /// Range of grid columns (or rows), including both limits.
  struct Range {
    int first, last;
  };
  /// Returns the grid columns (or rows) whose window centres are nearest to a position: one, or two if both are equally
  /// near. @pre size() > 0
  GLADSTONE_HD Range nearest(GridAxis axis, double position_px) const {
    using std::ceil;
    using std::floor;
    double const node = (position_px - centre(axis, 0)) / spacing_px;
    int const last = windows(axis) - 1, low = static_cast<int>(ceil(node - 0.5)),
              high = static_cast<int>(floor(node + 0.5));
    return {low < 0 ? 0 : (low < last ? low : last), high < 0 ? 0 : (high < last ? high : last)};
  }
};

/// Returns the distance between neighbouring windows, rounded to whole pixels, at least 1 [px].
inline int grid_spacing_px(int window_px, double overlap) {
  int const spacing = static_cast<int>(std::lround(window_px * (1.0 - overlap)));
  return spacing > 1 ? spacing : 1;
}

/// Creates the grid of the last pass, on which the vectors are reported. Its first window starts at pixel (0, 0).
/// @param overlap  fraction of the window side shared by neighbouring windows, [0, 1); the spacing is rounded to whole
/// pixels
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

/// Creates a grid centred on the image, so that a mirrored image has mirrored windows.
/// Windows start at whole pixels, so the unused margin along each axis must be an even number of pixels. If it is odd
/// along either axis and the spacing is even, the spacing is reduced by one pixel on both axes; if the margin of an
/// axis is still odd, the number of windows along this axis is reduced by one. With a single window along an axis, the
/// grid may be half a pixel off centre.
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

}  // namespace gladstone::inline correlation
