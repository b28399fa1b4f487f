#pragma once

#include <cmath>
#include <cstddef>

#include "render/base/contracts.h"
#include "render/base/host_device.h"
#include "render/base/vec.h"

namespace gladstone {

/// Where the interrogation windows of one pass lie: square windows of nominal size window_px, every one inside the
/// image, the first on pixels 0 .. window_px - 1 of either axis. Vector i stands at column i % columns, row i /
/// columns.
struct InterrogationGrid {
  int window_px = 0;   ///< nominal window size
  int spacing_px = 1;  ///< distance of neighbouring windows
  int columns = 0;     ///< windows in a row; 0 where the image is smaller than a window
  int rows = 0;

  GLADSTONE_HD std::size_t size() const { return static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows); }
  /// Centre of the windows of grid column (or row) `index` along its axis [px]: (window_px - 1)/2 from the window's
  /// first pixel, hence half-integer for the even windows we use.
  GLADSTONE_HD double centre(int index) const {
    return 0.5 * (window_px - 1) + static_cast<double>(index) * spacing_px;
  }
  GLADSTONE_HD Vec2d centre(std::size_t vector) const {
    return {centre(static_cast<int>(vector % static_cast<std::size_t>(columns))),
            centre(static_cast<int>(vector / static_cast<std::size_t>(columns)))};
  }
  /// The vector whose window's centre is nearest to a place in the image. @pre size() > 0
  GLADSTONE_HD std::size_t nearest(Vec2d position) const {
    auto const index = [&](double along, int count) {
      int const k = static_cast<int>(std::lround((along - centre(0)) / spacing_px));
      return k < 0 ? 0 : (k < count ? k : count - 1);
    };
    return static_cast<std::size_t>(index(position.y, rows)) * static_cast<std::size_t>(columns) +
           static_cast<std::size_t>(index(position.x, columns));
  }
};

/// Distance of neighbouring windows [px], whole.
inline int grid_spacing_px(int window_px, double overlap) {
  int const spacing = static_cast<int>(std::lround(window_px * (1.0 - overlap)));
  return spacing > 1 ? spacing : 1;
}

/// The grid of a pass on an image of the given size.
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

}  // namespace gladstone
