#pragma once

#include <array>
#include <vector>

#include "analysis/correlation/correlation_settings.h"
#include "analysis/stereo/reconstruct.h"
#include "render/scene/ground_truth.h"

namespace gladstone {

/// Computes the true displacement at the nodes: the mean over the particles in the interrogation window, which is
/// projected onto the plane, with the weights of window_truth() and the light that both cameras receive.
/// @param dots     truth of the two cameras, with the same particles
/// @param cameras  whose mean pixel sizes along x and y are those of the window
/// @return         [m, grid.size()]; NaN: fewer than three particles
std::vector<Vec3d> compute_stereo_truth(std::array<GroundTruth const*, 2> const& dots,
                                        std::array<PinholeCamera const*, 2> const& cameras,
                                        stereo::NodeGrid const& grid, stereo::ObjectPlane const& plane,
                                        CorrelationSettings const& settings);

}  // namespace gladstone
