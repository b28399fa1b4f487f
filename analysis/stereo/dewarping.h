#pragma once

#include <array>

#include "analysis/stereo/node_grid.h"
#include "analysis/stereo/stereo_camera.h"
#include "render/base/image.h"

namespace gladstone::inline stereo {

/// Plane onto which images are dewarped, and the pixels of the dewarped images.
struct Dewarping {
  ObjectPlane plane;
  NodeGrid grid;
};

/// Returns the grid of pixels that covers the part of a plane that is visible in both images.
/// @param size        columns and rows of the images [px]
/// @param pixel_size  distance between pixels on the plane [m]
/// @return empty if the views do not overlap
NodeGrid find_common_view(std::array<PinholeCamera const*, 2> const& cameras,
                          std::array<std::array<int, 2>, 2> const& size, ObjectPlane const& plane, double pixel_size);

/// Dewarps an image: each pixel of the result shows the grey level of the camera's image at the projection of a node,
/// interpolated by cubic convolution. Row 0 contains the nodes with the largest y, so that the dewarped image is
/// upright.
/// @return dewarped image; NaN at nodes whose projection is outside the camera's image or less than two pixels inside
///         its border
Image<double> dewarp_image(Image<double> const& image, PinholeCamera const& camera, ObjectPlane const& plane,
                           NodeGrid const& grid);

}  // namespace gladstone::inline stereo
