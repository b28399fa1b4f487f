#pragma once

#include <vector>

#include "analysis/errors/window_truth.h"
#include "render/scene/renderer.h"

namespace gladstone {

/// Truth of PIV at places of the picture, for virtual particles in the middle of the laser sheet.
struct ParticlePoints {
  GroundTruth seen;               ///< with the medium: of the particle whose image is at the place at mid-time
  std::vector<Vec2d> ambient_px;  ///< displacement without the medium: of the particle that would be seen there
  /// The flow's velocity where the camera sees that place of the sheet, times dt: its part in the sheet, by the
  /// derivatives of the camera's projection there.
  std::vector<Vec2d> flow_px;
};

/// Virtual particles of the particles' median diameter move along the flow by half of dt to either side of mid-time,
/// and send light alike into all directions; two rounds of correction with few rays bring their images to the places,
/// then all rays are traced. NaN where the camera sees no place of the sheet.
/// @param at whether a place is that of mid-time, half the displacement away from the first image, or the first image's
ParticlePoints particle_points(Scene& scene, Renderer& renderer, std::vector<Vec2d> const& places_px, TruthAt at);

/// Displacements with the medium alone, of the particles that particle_points() finds [px]. Without medium, through an
/// ideal thin lens on the Z axis, no ray is traced: the pinhole projection is exact there.
std::vector<Vec2d> particle_displacements(Scene& scene, Renderer& renderer, std::vector<Vec2d> const& places_px,
                                          TruthAt at);

}  // namespace gladstone
