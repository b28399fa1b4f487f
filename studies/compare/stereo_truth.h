#pragma once

#include <array>
#include <vector>

#include "analysis/correlation/correlation_settings.h"
#include "analysis/stereo/reconstruct.h"
#include "render/scene/ground_truth.h"

namespace gladstone::inline compare {

/// Computes the number of pixels per metre along x and y of a plane, mean of the cameras [px/m].
Vec2d find_plane_scale(std::array<PinholeCamera const*, 2> const& cameras, stereo::ObjectPlane const& plane);

/// Computes the true displacement at the nodes: the mean over the particles in the interrogation window, which is
/// projected onto the plane, with the weights of window_truth() and the light that both cameras receive.
/// @param dots   truth of the two cameras, with the same particles
/// @param scale  pixels per metre along x and y, which determine the size of the window on the plane [px/m]
/// @return       [m, grid.size()]; NaN: fewer than three particles
std::vector<Vec3d> compute_stereo_truth(std::array<GroundTruth const*, 2> const& dots, Vec2d scale,
                                        stereo::NodeGrid const& grid, CorrelationSettings const& settings);

}  // namespace gladstone::inline compare
