#include <fmt/format.h>

#include "analysis/preparation/frame_changes.h"
#include "render/base/error.h"
#include "render/base/vec.h"

namespace gladstone::inline preparation {
namespace {

/// Returns true if a point is inside a polygon: a ray to the right crosses its sides an odd number of times.
bool is_inside(std::vector<Vec2d> const& corners, Vec2d p) {
  bool inside = false;
  for (std::size_t k = 0, before = corners.size() - 1; k < corners.size(); before = k++) {
    Vec2d const a = corners[before], b = corners[k];
    if ((a.y > p.y) == (b.y > p.y)) continue;
    if (p.x < a.x + (p.y - a.y) / (b.y - a.y) * (b.x - a.x)) inside = !inside;
  }
  return inside;
}

}  // namespace

FrameChange make_polygon_mask(std::vector<Vec2d> const& corners) {
  return [corners](PreparedFrames& frames) {
    int const columns = frames.known.columns(), rows = frames.known.rows();
    bool any = false;
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < columns; ++i) {
        if (corners.empty() || !is_inside(corners, {static_cast<double>(i), static_cast<double>(j)})) continue;
        frames.known(i, j) = 0.0;
        any = true;
      }
    if (!any)
      throw DataError(
          ErrorCode::invalid_value, KeyPath{"correlate.mask"},
          fmt::format("the polygon from ({:g}, {:g}) contains no pixel centre of the frames ({} x {} px); give its "
                      "corners in px, from 0 at the centre of the first pixel, y downwards",
                      corners.empty() ? 0.0 : corners[0].x, corners.empty() ? 0.0 : corners[0].y, columns, rows));
  };
}

}  // namespace gladstone::inline preparation
