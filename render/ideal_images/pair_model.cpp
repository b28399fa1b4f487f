#include "render/ideal_images/pair_model.h"

#include <limits>
#include <type_traits>

#include "render/base/error.h"
#include "render/ideal_images/ideal_images.h"
#include "render/light/particle_motion.h"
#include "render/scene/build_camera.h"
#include "render/scene/particle_scene.h"

namespace gladstone {

static_assert(std::is_trivially_copyable_v<PairModel>);

namespace {

constexpr std::size_t planned_paths = 1024;  // particles from which the number of integration steps is chosen

ExposureRule exposure_rule(CameraSetup const& camera) {
  ExposureRule rule;
  rule.by_photons = camera.absolute_exposure;
  rule.fixed_e = camera.exposure_e.value_or(0);
  rule.brightest_e = Detector::auto_exposure(camera, 1);
  rule.full_well_e = Detector::auto_exposure(camera, 0);
  rule.per_photon = camera.noise.enabled || camera.absolute_exposure ? camera.noise.quantum_efficiency
                                                                     : std::numeric_limits<double>::infinity();
  return rule;
}

/// Chooses the number of integration steps from particles of the setup's own seed.
int choose_steps(ParticleSetup const& particles, FlowSetup const& flow, SeedingPlan const& plan, double pixel_size) {
  std::vector<Vec3d> middle;
  std::vector<double> const diameters(planned_paths, particles.diameter.middle);
  for (std::size_t i = 0; i < planned_paths; ++i) {
    KeyedEngine engine(particles.seed, RandomStream::particles, i);
    middle.push_back(draw_place(engine, particles.center, plan.size));
  }
  return plan_paths(particles, flow, middle, diameters, flow.dt / 2, path_tolerance_px * pixel_size).steps;
}

}  // namespace

std::string reason_against_pair_model(Setup const& setup) {
  if (std::string const reason = reason_against_ideal_images(setup); !reason.empty()) return reason;
  ParticleSetup const& particles = setup.piv->particles;
  if (particles.scattering != ParticleScattering::gaussian) return "particles.scattering is not \"gaussian\"";
  if (particles.count == ParticleCount::file) return "the particles are read from a file";
  if (particles.diameter.spread == DiameterSpread::table) return "the diameters are read from a file";
  if (setup.sequence) return "the pairs of a sequence share their particles";
  if (!setup.camera.background.glare_file.empty()) return "the camera has a glare image";
  if (ParticleVelocity{setup.piv->flow.flow}.exact()) return "particles cross a shock";
  return "";
}

OwnedPairModel build_pair_model(Setup const& setup) {
  if (std::string const reason = reason_against_pair_model(setup); !reason.empty())
    throw DataError(ErrorCode::unsupported, KeyPath{"particles.scattering"},
                    "pairs cannot be rendered in batches (" + reason + ")");
  Scene scene;  // without particles, which differ between pairs
  scene.setup = setup;
  scene.imaging = setup.imaging();
  scene.camera = build_camera(setup);
  FlowSetup& flow = scene.setup.piv->flow;
  load_flow(flow);
  ParticleSetup const& particles = setup.piv->particles;
  CameraSetup const& camera = setup.camera;
  SeedingPlan const plan = plan_seeding(particles, particle_count(scene.setup), flow);
  PairModel model;
  model.seeded = plan.count;
  model.center = particles.center;
  model.volume = *particles.volume;
  model.box = plan.size;
  model.spread = particles.diameter.spread;
  model.diameter = particles.diameter.middle;
  model.diameter_width = particles.diameter.width;
  model.density = particles.density.value_or(0);
  model.viscosity = particles.viscosity;
  model.flow = flow.flow;
  model.dt = flow.dt;
  model.interval = particle_velocity(particles, flow, particles.diameter.middle).interval;
  model.steps = choose_steps(particles, flow, plan, setup.pixel_size());
  model.sheet = laser_sheet(setup.piv->laser);
  model.sheet_plane = scene.sheet_plane();
  model.lens = {scene.camera.aim_plane.origin, scene.camera.aim_plane.z, LensLight::area(scene.imaging.entrance_pupil)};
  model.projection = ideal_images(scene).value().projection();
  model.spot = {scene.spot_sigma_px()};
  model.exposure = exposure_rule(camera);
  model.detector = Detector(camera, 0).pixel();
  return {model, flow.owner};
}

}  // namespace gladstone
