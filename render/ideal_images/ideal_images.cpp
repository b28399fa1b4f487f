#include "render/ideal_images/ideal_images.h"

#include <algorithm>
#include <cmath>

namespace gladstone::inline ideal_images {

IdealProjection IdealImages::projection() const {
  CameraSetup const& camera = scene_->setup.camera;
  return {scene_->imaging.image_distance, scene_->setup.z_a, camera.pixel_pitch, camera.columns, camera.rows};
}

DefocusBlur IdealImages::blur() const {
  Setup const& setup = scene_->setup;
  ImagingGeometry const& imaging = scene_->imaging;
  bool const neglected = setup.has_ideal_particles();
  double const diameter_px = imaging.magnification * imaging.entrance_pupil / setup.camera.pixel_pitch;
  return {scene_->spot_sigma_px(), setup.z_a, neglected ? 0 : diameter_px / 2};
}

double IdealImages::largest_blur_error(Particles const& particles) const {
  DefocusBlur const spread = blur();
  double brightest = 0, worst = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    for (int pulse = 0; pulse < 2; ++pulse) {
      double const light = particles.photons[pulse][i] * particles.diameter[i] * particles.diameter[i];
      if (!(light > 0)) continue;
      brightest = std::max(brightest, light);
      worst = std::max(worst, light * spread.error(particles.place[pulse][i].z));
    }
  }
  return brightest > 0 ? worst / brightest : 0;
}

// Circle of confusion of a point at distance Z - z from the lens, z in front of the plane in focus at Z: a disc of
// diameter M D |z| / (Z - z) on the sensor (exact for a thin lens; Olsen & Adrian 2000).
double IdealImages::largest_blur_px(Particles const& particles) const {
  double most = 0;
  for (std::size_t i = 0; i < particles.size(); ++i) {
    for (int pulse = 0; pulse < 2; ++pulse) {
      double const z = particles.place[pulse][i].z;
      if (particles.photons[pulse][i] > 0) most = std::max(most, std::abs(z) / (scene_->setup.z_a - z));
    }
  }
  ImagingGeometry const& imaging = scene_->imaging;
  return imaging.magnification * imaging.entrance_pupil * most / scene_->setup.camera.pixel_pitch;
}

std::string reason_against_ideal_images(Setup const& setup) {
  if (setup.experiment().sources.on_target) return "only particles have ideal images";
  if (setup.medium.field.kind != FieldKind::none || setup.medium.second_field) return "the medium deflects rays";
  if (std::string reason = setup.reason_against_closed_form(); !reason.empty()) return reason;
  if (setup.lens.focus != Focus::target) return "the lens is not focused on the sheet";
  if (!std::isfinite(setup.lens.f_number)) return "the lens has no stop, and hence no diffraction";
  if (setup.lens.spot == SpotModel::none || setup.lens.spot == SpotModel::airy)
    return "the point spread function is not Gaussian";
  return "";
}

std::optional<IdealImages> build_ideal_images(Scene const& scene) {
  if (!reason_against_ideal_images(scene.setup).empty()) return std::nullopt;
  return IdealImages(scene);
}

}  // namespace gladstone::inline ideal_images
