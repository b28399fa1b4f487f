#include "render/scene/light_through_lens.h"

#include <algorithm>
#include <limits>
#include <mutex>

#include "render/base/parallel.h"
#include "render/light/lambert_sphere.h"
#include "render/sensor/detector.h"

namespace gladstone::inline scene {

LightThroughLens::LightThroughLens(Scene const& scene, ParticleLight light)
    : scene_(scene),
      light_(light),
      sheet_(laser_sheet(scene.setup.piv->laser)),
      lens_{scene.camera.aim_plane.origin, scene.camera.aim_plane.z, LensLight::area(scene.imaging.entrance_pupil)} {
  if (scene.mie) mie_ = scene.mie->view();
}

double LightThroughLens::cross_section(Vec3d place, Vec3d direction, std::size_t particle, int pulse) const {
  if (light_ == ParticleLight::equal) return 1;
  if (scene_.setup.has_ideal_particles()) {
    return isotropic_cross_section(scene_.particles.diameter[particle]);
  }
  LightWave<double> const wave = sheet_.wave(place, pulse);
  if (scene_.mie) return mie_.cross_section(particle, direction, wave);
  return LambertSpheres<double>{scene_.particles.diameter.data()}.cross_section(particle, direction, wave);
}

double LightThroughLens::operator()(Vec3d place, std::size_t particle, int pulse) const {
  Vec3d const way = lens_.centre - place;
  double const far = length(way);
  return lens_(cross_section(place, way / far, particle, pulse), way, far);
}

double photons_through_lens(Scene const& scene, std::size_t particle, int pulse) {
  LightThroughLens const through_lens(scene);
  Particles const& particles = scene.particles;
  return particles.photons[pulse][particle] * through_lens(particles.place[pulse][particle], particle, pulse);
}

double brightest_photons(Scene const& scene, Particles const& particles, ParticleLight light) {
  LightThroughLens const through_lens(scene, light);
  std::mutex merge;
  double brightest = 0;
  parallel_chunks(particles.size(), 4096, [&](std::size_t begin, std::size_t end) {
    double most = 0;
    for (std::size_t i = begin; i < end; ++i) {
      for (int pulse = 0; pulse < 2; ++pulse) {
        double const photons = particles.photons[pulse][i];
        if (photons > 0) most = std::max(most, photons * through_lens(particles.place[pulse][i], i, pulse));
      }
    }
    std::lock_guard const lock(merge);
    brightest = std::max(brightest, most);
  });
  return brightest;
}

double photon_limited_exposure(Scene const& scene) {
  NoiseSetup const& noise = scene.setup.camera.noise;
  if (!scene.setup.experiment().sources.in_photons || !noise.enabled) return std::numeric_limits<double>::infinity();
  return scene.photon_unit * noise.quantum_efficiency;
}

double choose_exposure(Scene const& scene, RenderedLight const& light) {
  CameraSetup const& camera = scene.setup.camera;
  if (camera.absolute_exposure) return scene.photon_unit * camera.noise.quantum_efficiency;
  if (camera.exposure_e) return *camera.exposure_e;
  return std::min(Detector::auto_exposure(camera, light.brightest()), photon_limited_exposure(scene));
}

double photon_unit(Scene const& scene, Particles const& particles, ParticleLight light) {
  if (light == ParticleLight::scattered) return scene.photon_unit;
  double const brightest = brightest_photons(scene, particles, light);
  return brightest > 0 ? brightest : 1;
}

}  // namespace gladstone::inline scene
