#pragma once

#include "render/scene/renderer.h"

namespace gladstone {

/// The general renderer on the CPU's cores: any source through any camera, ray by ray. Every ray's spot is laid down
/// where it lands; truth is the centroid of the rays that pass the stop in either frame, its error the scatter between
/// independent scramblings of them.
class RaysRenderer : public Renderer {
 public:
  std::string device() const override { return "cpu"; }
  Rendering render(Scene& scene, DotPattern const& sources, RenderImages images, RenderTheory theory) override;
  Rendering render_particles(Scene& scene, Particles const& particles, ParticleLight light,
                             RenderImages images) override;
};

/// Displacements of sources as an ideal lens in their place would image them [px]: every ray of the actual camera that
/// passes its stop counts, in both frames, but lands where the collinear map (Camera::ideal_project) has the image of
/// the point of the target that it seems to come from. What the actual lens adds, defocus included, is its aberration.
/// NaN where no ray gets through.
std::vector<Vec2d> ideal_displacements(Scene const& scene, DotPattern const& sources);

/// A white target seen by the camera: light per pixel, what dark dots are taken from.
Image<double> white_picture(Scene const& scene);

}  // namespace gladstone
