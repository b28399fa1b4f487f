#include <algorithm>
#include <cmath>
#include <limits>

#include "analysis/stereo/interpolated_field.h"
#include "analysis/stereo/reconstruct.h"

namespace gladstone::inline stereo {
namespace {

/// Bounding box of a camera's vectors projected onto the plane, and the mean distance between neighbouring vectors on
/// the plane.
struct Footprint {
  Vec2d low{std::numeric_limits<double>::infinity(), std::numeric_limits<double>::infinity()};
  Vec2d high = -low;
  /// Mean distance of neighbouring vectors [m]; NaN: no lines of sight of neighbouring vectors meet the plane.
  double spacing = 0.0;
};

Footprint find_footprint(PinholeCamera const& camera, DisplacementField const& field, ObjectPlane const& plane,
                         std::optional<Dewarping> const& dewarping) {
  Footprint footprint;
  std::vector<std::optional<Vec2d>> at(field.size());
  for (std::size_t i = 0; i < field.size(); ++i) {
    at[i] = dewarping ? dewarping->grid.position_of_pixel(field.position_px[i])
                      : intersect_plane(camera, field.position_px[i], plane);
    if (!at[i] || !field.counts(i)) continue;
    footprint.low = {std::min(footprint.low.x, at[i]->x), std::min(footprint.low.y, at[i]->y)};
    footprint.high = {std::max(footprint.high.x, at[i]->x), std::max(footprint.high.y, at[i]->y)};
  }
  double area = 0.0, cells = 0.0;
  auto const columns = static_cast<std::size_t>(field.columns);
  for (std::size_t i = 0; i + columns < field.size(); ++i) {
    if (i % columns + 1 == columns || !at[i] || !at[i + 1] || !at[i + columns]) continue;
    Vec2d const right = *at[i + 1] - *at[i], down = *at[i + columns] - *at[i];
    area += std::abs(right.x * down.y - right.y * down.x);
    cells += 1.0;
  }
  footprint.spacing = std::sqrt(area / cells);
  return footprint;
}

}  // namespace

NodeGrid find_common_grid(CalibratedCamera const& camera_a, DisplacementField const& field_a,
                          CalibratedCamera const& camera_b, DisplacementField const& field_b, ObjectPlane const& plane,
                          double spacing, std::optional<Dewarping> const& dewarping) {
  Footprint const a = find_footprint(camera_a.camera, field_a, plane, dewarping);
  Footprint const b = find_footprint(camera_b.camera, field_b, plane, dewarping);
  double const distance = spacing > 0.0 ? spacing : 0.5 * (a.spacing + b.spacing);
  return NodeGrid::between({std::max(a.low.x, b.low.x), std::max(a.low.y, b.low.y)},
                           {std::min(a.high.x, b.high.x), std::min(a.high.y, b.high.y)}, distance);
}

}  // namespace gladstone::inline stereo
