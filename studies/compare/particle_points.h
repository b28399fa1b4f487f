#pragma once

#include <vector>

#include "analysis/errors/window_truth.h"
#include "render/scene/renderer.h"

namespace gladstone::inline compare {

/// PIV truth at points of the image, from virtual particles in the middle of the laser sheet.
struct ParticlePoints {
  GroundTruth seen;  ///< truth with the medium, of the particle whose image is at the point at mid-time (see TruthAt)
  /// displacement, without the medium, of the particle whose image would then be at the point [px]
  std::vector<Vec2d> ambient_px;
  /// Velocity of the flow times dt at the point of the sheet seen by the camera, projected into the image by the
  /// derivatives of the camera's projection there [px].
  std::vector<Vec2d> flow_px;
};

/// Traces virtual particles of the median diameter that follow the flow by dt/2 before and after mid-time and scatter
/// light equally in all directions. Two corrections with few rays shift the particles until their images coincide with
/// the points; then all rays are traced. NaN if the camera sees no point of the sheet there.
/// @param places_px  points in the image [px]
/// @param at         mid_position: a point is the midpoint of both images; reference: the position of the first image
ParticlePoints particle_points(Scene const& scene, RenderPlan const& plan, Renderer& renderer,
                               std::vector<Vec2d> const& places_px, TruthAt at);

/// Returns true if the pinhole projection gives the displacements of particles exactly: without a medium, and with an
/// ideal thin lens on the Z axis.
bool has_projected_displacements(Scene const& scene);

/// Computes only the displacements with the medium of the particles found by particle_points(), and their standard
/// errors unless they are projected instead of traced.
GroundTruth particle_displacements(Scene const& scene, RenderPlan const& plan, Renderer& renderer,
                                   std::vector<Vec2d> const& places_px, TruthAt at);

}  // namespace gladstone::inline compare
