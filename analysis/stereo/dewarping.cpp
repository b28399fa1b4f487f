#include "analysis/stereo/dewarping.h"

#include <algorithm>
#include <limits>

#include "analysis/stereo/cubic_convolution.h"
#include "render/base/not_a_number.h"
#include "render/base/parallel.h"

namespace gladstone::inline stereo {
namespace {

/// Interpolates an image. @return NaN at positions outside the image or less than two pixels inside its border
double sample_image(Image<double> const& image, Vec2d at) {
  if (!(at.x >= 1.0 && at.y >= 1.0 && at.x < image.columns() - 2 && at.y < image.rows() - 2)) return not_a_number;
  int const column = static_cast<int>(at.x), row = static_cast<int>(at.y);
  auto const by_column = cubic_weights(at.x - column), by_row = cubic_weights(at.y - row);
  double sum = 0.0;
  for (int j = 0; j < 4; ++j)
    for (int i = 0; i < 4; ++i)
      sum += by_row[static_cast<std::size_t>(j)] * by_column[static_cast<std::size_t>(i)] *
             image(column + i - 1, row + j - 1);
  return sum;
}

}  // namespace

NodeGrid find_common_view(std::array<PinholeCamera const*, 2> const& cameras,
                          std::array<std::array<int, 2>, 2> const& size, ObjectPlane const& plane, double pixel_size) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Vec2d low{-infinity, -infinity}, high{infinity, infinity};
  for (std::size_t camera = 0; camera < cameras.size(); ++camera) {
    Vec2d lowest{infinity, infinity}, highest = -lowest;
    for (double const x : {0.0, 0.5, 1.0})  // corners of the image and middles of its edges
      for (double const y : {0.0, 0.5, 1.0}) {
        auto const at =
            intersect_plane(*cameras[camera], {x * (size[camera][0] - 1), y * (size[camera][1] - 1)}, plane);
        if (!at) continue;
        lowest = {std::min(lowest.x, at->x), std::min(lowest.y, at->y)};
        highest = {std::max(highest.x, at->x), std::max(highest.y, at->y)};
      }
    low = {std::max(low.x, lowest.x), std::max(low.y, lowest.y)};
    high = {std::min(high.x, highest.x), std::min(high.y, highest.y)};
  }
  return NodeGrid::between(low, high, pixel_size);
}

Image<double> dewarp_image(Image<double> const& image, PinholeCamera const& camera, ObjectPlane const& plane,
                           NodeGrid const& grid) {
  Image<double> dewarped(grid.columns, grid.rows);
  auto const columns = static_cast<std::size_t>(grid.columns);
  parallel_for(static_cast<std::size_t>(grid.rows), [&](std::size_t row) {
    for (std::size_t column = 0; column < columns; ++column) {
      Vec3d const node = plane.point(grid.position(row * columns + column));
      dewarped(static_cast<int>(column), grid.rows - 1 - static_cast<int>(row)) =
          sample_image(image, camera.project(node));
    }
  });
  return dewarped;
}

}  // namespace gladstone::inline stereo
