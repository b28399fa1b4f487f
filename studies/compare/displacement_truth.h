#pragma once

#include "analysis/errors/window_truth.h"
#include "render/base/image.h"
#include "render/scene/renderer.h"

namespace gladstone::inline compare {

/// Pixels to which rays are traced.
enum class TracedPixels {
  adaptive,  ///< every fourth column and row, and all pixels near which the displacement is not smooth
  all,
};

/// Computes true displacements at the pixels of a case's images from its flow or medium and its camera, independently
/// of the case's dots or particles. TracedPixels::adaptive: rays are traced to every fourth column and row, and to all
/// pixels around which the displacement deviates from its cubic interpolation over 8 px by more than 5e-4 px and four
/// standard errors; see refine_map() for the others. Features below 4 px can be missed. Without a medium, particles are
/// projected at every pixel. Node (column, row) is the centre of pixel (column, row) * spacing_px.
/// - PIV: displacement of a particle in the middle of the laser sheet that follows the flow as the median particle
///   does.
/// - BOS: displacement of a dot of the target's size.
/// @param scene       prepared scene with step and rays; not modified
/// @param at          reference: of the source seen at the pixel in frame A; mid_position: of the source whose
///                    positions in both frames have this pixel as their midpoint (mid-time, except for the curvature of
///                    its path)
/// @param spacing_px  distance between nodes [px]
/// @return [px], u right, v down; NaN: no light reaches the pixel from there
Image<Vec2d> displacement_truth(Scene const& scene, RenderPlan const& plan, Renderer& renderer, TruthAt at,
                                int spacing_px, TracedPixels traced = TracedPixels::adaptive);

}  // namespace gladstone::inline compare
