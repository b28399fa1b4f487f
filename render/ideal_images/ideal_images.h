#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "render/ideal_images/particle_image.h"
#include "render/scene/renderer.h"

namespace gladstone::inline ideal_images {

/// Scene whose particles have ideal images: in focus of an ideal thin lens with a stop, on and perpendicular to the
/// axis, without other optical elements or medium, with a Gaussian PSF.
/// The image of a particle is a Gaussian centred on its pinhole projection and integrated over pixels, as in other PIV
/// image generators (Raffel et al. 2018, section 3; Lecordier & Westerweel 2004), without ray tracing. It is widened by
/// the defocus due to the particle's depth in the sheet (DefocusBlur), which ParticleScattering::gaussian neglects: see
/// largest_blur_px(). Created by build_ideal_images() only; refers to the scene, which must outlive it.
class IdealImages {
 public:
  Scene const& scene() const { return *scene_; }
  /// Returns the projection of points to the sensor.
  IdealProjection projection() const;
  /// Returns the image position of a point [px].
  Vec2d project(Vec3d place) const { return projection()(place); }
  /// Returns the widening of the images by defocus.
  DefocusBlur blur() const;
  /// Returns the largest error of the images due to DefocusBlur, relative to the brightest one [1].
  double largest_blur_error(Particles const& particles) const;
  /// Returns the diameter of the circle of confusion of the illuminated particle that is farthest out of focus [px].
  double largest_blur_px(Particles const& particles) const;

 private:
  explicit IdealImages(Scene const& scene) : scene_(&scene) {}
  friend std::optional<IdealImages> build_ideal_images(Scene const& scene);

  Scene const* scene_;
};

/// Returns the reason why the particles of a setup do not have ideal images; empty if they do.
std::string reason_against_ideal_images(Setup const& setup);

/// Returns the scene for ideal images; nullopt if its particles do not have ideal images.
std::optional<IdealImages> build_ideal_images(Scene const& scene);

/// Draws the images of particles on one device.
class ImageDrawer {
 public:
  virtual ~ImageDrawer() = default;
  virtual std::string device() const = 0;
  /// Returns the light of both frames. A pixel adds up its contributions in the order of the images. Images without
  /// light are ignored.
  /// @param shape  PSF whose footprint is used for all images
  virtual std::shared_ptr<RenderedLight const> draw(std::array<std::vector<ParticleImage>, 2> const& images,
                                                    GaussianSpot<double> const& shape, int columns, int rows) = 0;
};

/// Renders images and truth of particles (the scene's own or virtual ones) by formula.
/// Light is in units of photon_unit(); that of a particle follows from its intensity towards the lens' centre. The
/// truth has no error. The result is bitwise identical for any number of threads.
/// @param drawer  device that draws the images, with the same result on every device; null: the CPU
Rendering render_ideal_images(IdealImages const& ideal, Particles const& particles, ParticleLight light,
                              RenderImages images, ImageDrawer* drawer = nullptr);

}  // namespace gladstone::inline ideal_images
