#pragma once

#include <optional>
#include <string>

#include "render/scene/renderer.h"

namespace gladstone {

/// A scene whose particles have ideal images: in focus of an ideal thin lens with a stop, on the axis and square to it,
/// with nothing in the way and a Gaussian spot. Such an image is that spot about the pinhole's projection of the
/// particle, integrated over pixels, as generators of PIV images have it (Raffel et al. 2018, section 3; Lecordier &
/// Westerweel 2004); no rays are needed. What a particle's place in the depth of the sheet blurs is left out: see
/// largest_blur_px(). Only ideal_images() gives it; it looks at the scene, which must outlive it.
class IdealImages {
 public:
  Scene const& scene() const { return *scene_; }
  /// Where a particle is seen [px].
  Vec2d project(Vec3d place) const;
  /// Diameter of the disc of confusion of the particle that is furthest out of focus of all that are lit [px].
  double largest_blur_px(Particles const& particles) const;

 private:
  explicit IdealImages(Scene const& scene) : scene_(&scene) {}
  friend std::optional<IdealImages> ideal_images(Scene const& scene);

  Scene const* scene_;
};

/// Why a setup is none of these; empty: it is.
std::string reason_against_ideal_images(Setup const& setup);

/// The one door to ideal images.
std::optional<IdealImages> ideal_images(Scene const& scene);

/// Images and truth of particles by formula, the scene's own or virtual ones: light in units of photon_unit(), that
/// of a particle by what it sends to the lens' middle; truth without error. The same bits on any number of threads.
Rendering render_ideal_images(IdealImages const& ideal, Particles const& particles, ParticleLight light,
                              RenderImages images);

}  // namespace gladstone
