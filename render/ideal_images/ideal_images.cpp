#include "render/ideal_images/ideal_images.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "render/base/freed_memory.h"
#include "render/base/not_a_number.h"
#include "render/base/parallel.h"
#include "render/ideal_images/draw_light.h"
#include "render/scene/light_through_lens.h"

namespace gladstone::inline ideal_images {
namespace {

constexpr int frames = 2;

/// Returns the PSF of the widest image that is not faint. Its footprint is used for all images.
GaussianSpot<double> find_widest(std::array<std::vector<ParticleImage>, frames> const& spots, double sigma) {
  double brightest = 0;
  for (auto const& frame : spots)
    for (ParticleImage const& spot : frame) brightest = std::max(brightest, spot.light);
  for (auto const& frame : spots)
    for (ParticleImage const& spot : frame)
      if (spot.light > faint_image * brightest) sigma = std::max(sigma, spot.sigma);
  return {sigma};
}

/// Returns the truth of particles with given image positions, and light in photons.
GroundTruth truth_of(Particles const& particles, std::array<std::vector<ParticleImage>, frames> const& spots) {
  GroundTruth truth;
  truth.resize(particles.size());
  truth.position_m = particles.place[0];
  truth.particles.second_m = particles.place[1];
  truth.particles.diameter_m = particles.diameter;
  for (auto* const theory : {&truth.eq9_px, &truth.chief_px, &truth.eq9_cone_px})
    theory->assign(truth.size(), {not_a_number, not_a_number});
  parallel_chunks(truth.size(), 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      ParticleImage const &first = spots[0][i], &second = spots[1][i];
      bool const both = first.light > 0 && second.light > 0;
      truth.reference_px[i] = first.light > 0 ? first.at : Vec2d{not_a_number, not_a_number};
      truth.displacement_px[i] = both ? second.at - first.at : Vec2d{not_a_number, not_a_number};
      truth.displacement_error_px[i] = both ? Vec2d{} : Vec2d{not_a_number, not_a_number};
      truth.displacement_std_px[i] = second.light > 0 ? Vec2d{} : Vec2d{not_a_number, not_a_number};
      truth.flux[i] = {first.light, second.light};
    }
  });
  truth.particles.reference_ambient_px = truth.reference_px;
  truth.particles.displacement_ambient_px = truth.displacement_px;
  return truth;
}

}  // namespace

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

Rendering render_ideal_images(IdealImages const& ideal, Particles const& particles, ParticleLight light,
                              RenderImages images, ImageDrawer* drawer) {
  keep_freed_memory();  // Retain freed memory: for successive pairs, page faults took a third of the time.
  Scene const& scene = ideal.scene();
  LightThroughLens const through_lens(scene, light);
  IdealProjection const project = ideal.projection();
  DefocusBlur const blur = ideal.blur();
  std::array<std::vector<ParticleImage>, frames> spots;
  for (std::size_t pulse = 0; pulse < frames; ++pulse) {
    spots[pulse].resize(particles.size());
    parallel_chunks(particles.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        double const photons = particles.photons[pulse][i];
        if (!(photons > 0)) continue;
        Vec3d const place = particles.place[pulse][i];
        double const light = photons * through_lens(place, i, static_cast<int>(pulse));
        spots[pulse][i] = {project(place), light, blur.width(place.z)};
      }
    });
  }
  Rendering rendering;
  rendering.table = TableState::by_formula;
  rendering.truth = truth_of(particles, spots);
  if (images == RenderImages::no) return rendering;
  double const unit = photon_unit(scene, particles, light);
  for (auto& frame : spots) {
    for (ParticleImage& spot : frame) spot.light /= unit;
  }
  GaussianSpot<double> const shape = find_widest(spots, blur.sigma);
  CameraSetup const& camera = scene.setup.camera;
  if (drawer) {
    rendering.in_place = drawer->draw(spots, shape, camera.columns, camera.rows);
    if (images == RenderImages::yes) rendering.light = std::exchange(rendering.in_place, nullptr)->to_host();
    return rendering;
  }
  rendering.light = {draw_light(spots[0], shape, camera.columns, camera.rows),
                     draw_light(spots[1], shape, camera.columns, camera.rows)};
  if (images == RenderImages::in_place) rendering.store_light_in_place();
  return rendering;
}

}  // namespace gladstone::inline ideal_images
