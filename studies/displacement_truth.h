#pragma once

#include "analysis/errors/window_truth.h"
#include "render/base/image.h"
#include "render/scene/renderer.h"

namespace gladstone {

/// True displacements at the pixels of a case's images, from its flow or medium and its camera: nothing is interpolated
/// between dots or particles. Node (column, row) is the centre of pixel (column, row) * spacing_px.
/// - PIV: of a particle in the middle of the laser sheet, which moves as the median particle does.
/// - BOS: of a dot of the target's size.
/// @param at reference: of what is seen at the pixel in the first frame; mid_position: of what is seen there midway
///           between its images in both frames, which is mid-time but for the curvature of its path
/// @param scene planned; traced through a copy
/// @return [px], u right, v down; NaN: no light reaches the pixel from there
Image<Vec2d> displacement_truth(Scene const& scene, Renderer& renderer, TruthAt at, int spacing_px);

}  // namespace gladstone
