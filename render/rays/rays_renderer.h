#pragma once

#include "render/scene/renderer.h"

namespace gladstone::inline rays {

/// General renderer on the CPU: any source through any camera, by ray tracing.
/// The PSF of every ray is added to the image where the ray lands. The truth is the centroid of the rays that pass the
/// stop in each image; its error is the scatter between independent scramblings of the rays.
class RaysRenderer : public Renderer {
 public:
  std::string device() const override { return "cpu"; }
  Rendering render(Scene const& scene, RenderPlan const& plan, DotPattern const& sources, RenderImages images,
                   RenderTheory theory) override;
  Rendering render_particles(Scene const& scene, RenderPlan const& plan, Particles const& particles,
                             ParticleLight light, RenderImages images) override;
};

/// Computes the displacements that an ideal lens in place of the actual one would produce [px].
/// Every ray of the actual camera that passes its stop is included, in both images, but is assigned the collinear image
/// (Camera::ideal_project) of the apparent point of origin on the target. The difference from the actual displacement
/// is the effect of aberrations, including defocus. NaN if no ray passes.
std::vector<Vec2d> ideal_displacements(Scene const& scene, RenderPlan const& plan, DotPattern const& sources);

/// Renders a white target: light per pixel, from which dark dots are subtracted.
/// @param seed  seed of the rays' random numbers
Image<double> render_white_target(Scene const& scene, std::uint64_t seed);

}  // namespace gladstone::inline rays
