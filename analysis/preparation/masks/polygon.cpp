#include <fmt/format.h>

#include "analysis/preparation/frame_changes.h"
#include "render/base/error.h"
#include "render/base/vec.h"

namespace gladstone {
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

FrameChange read_polygon_mask(SetupTable& table, FramePreparation&) {
  constexpr std::size_t fewest = 3, most = 10000;
  std::vector<double> const x = table.number_list("x_px", {}, fewest, most);
  std::vector<double> const y = table.number_list("y_px", {}, fewest, most);
  for (char const* key : {"x_px", "y_px"})
    if (!table.has(key))
      table.problem(key, "is missing (a polygon requires corners); give three or more numbers", ErrorCode::missing_key);
  if (!x.empty() && !y.empty() && x.size() != y.size())
    table.problem("y_px", "has another number of values than x_px (each corner has both coordinates); give as many");
  std::vector<Vec2d> corners;
  for (std::size_t k = 0; k < std::min(x.size(), y.size()); ++k) corners.push_back({x[k], y[k]});
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

}  // namespace gladstone
