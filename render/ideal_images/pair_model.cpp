#include "render/ideal_images/pair_model.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <type_traits>
#include <utility>

#include "render/base/error.h"
#include "render/ideal_images/ideal_images.h"
#include "render/light/particle_motion.h"
#include "render/scene/build_camera.h"
#include "render/scene/particle_scene.h"
#include "render/scene/scene.h"

namespace gladstone::inline ideal_images {

static_assert(std::is_trivially_copyable_v<PairModel>);

namespace {

constexpr std::size_t planned_paths = 1024;  // number of particles for which the number of integration steps is chosen

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

/// Chooses the number of integration steps of the particle paths, from particles drawn with the seed of the setup.
int choose_steps(ParticleSetup const& particles, FlowSetup const& flow, SeedingPlan const& plan, double pixel_size) {
  std::vector<Vec3d> middle;
  std::vector<double> const diameters(planned_paths, particles.diameter.middle);
  for (std::size_t i = 0; i < planned_paths; ++i) {
    KeyedEngine engine(particles.seed, RandomStream::particles, i);
    middle.push_back(draw_place(engine, particles.center, plan.size));
  }
  return plan_paths(particles, flow, middle, diameters, flow.dt / 2, path_tolerance_px * pixel_size).steps;
}

/// Largest image and error that defocus causes in a volume.
struct LargestBlur {
  double sigma = 0;  ///< standard deviation of the widest image that is not faint [px]
  double error = 0;  ///< DefocusBlur::error() times the light relative to that of the brightest point [1]
};

/// Determines the largest blur in the volume of the particles, on a lattice of points.
LargestBlur find_largest_blur(ParticleSetup const& particles, LaserSheet<double> const& sheet,
                              DefocusBlur const& blur) {
  constexpr int across = 5, deep = 129;
  double brightest = 0;
  LargestBlur largest{blur.sigma, 0};
  if (!(blur.reach > 0)) return largest;
  auto const each = [&](auto const& visit) {
    for (int k = 0; k < across * across * deep; ++k) {
      int const column = k % across, row = k / across % across, layer = k / (across * across);
      Vec3d const part{column / (across - 1.0) - 0.5, row / (across - 1.0) - 0.5, layer / (deep - 1.0) - 0.5};
      Vec3d const size = *particles.volume;
      Vec3d const place = particles.center + Vec3d{part.x * size.x, part.y * size.y, part.z * size.z};
      for (int pulse = 0; pulse < 2; ++pulse) visit(place.z, sheet.photons(place, pulse));
    }
  };
  each([&](double, double light) { brightest = std::max(brightest, light); });
  each([&](double z, double light) {
    if (light > faint_image * brightest) largest.sigma = std::max(largest.sigma, blur.width(z));
    if (light > 0) largest.error = std::max(largest.error, light / brightest * blur.error(z));
  });
  return largest;
}

/// Returns a scene without particles, which differ between pairs.
Scene empty_scene(Setup const& setup) {
  Scene scene;
  scene.setup = setup;
  scene.imaging = setup.imaging();
  scene.camera = build_camera(setup);
  return scene;
}

/// Tabulates the scattering of a setup whose particles have one diameter, for the angles at which the lens sees them.
/// These are found from a sample, and the table has a margin.
std::shared_ptr<MieScattering const> tabulate_scattering(Setup setup) {
  setup.piv->particles.count = ParticleCount::number;
  setup.piv->particles.amount = 4096;
  return build_scene(setup).mie;
}

/// Returns the reason why images of scattered light cannot be drawn by a formula; empty if they can.
std::string reason_against_scattering(Setup const& setup) {
  ParticleSetup const& particles = setup.piv->particles;
  if (particles.scattering == ParticleScattering::gaussian) return "";
  if (setup.render.method == RenderMethod::rays) return "render.method = \"rays\" traces rays";
  if (particles.scattering == ParticleScattering::mie && particles.diameter.spread != DiameterSpread::one)
    return "the diameters of every pair require another table of Mie scattering";
  Scene const scene = empty_scene(setup);
  double const error =
      find_largest_blur(particles, laser_sheet(setup.piv->laser), build_ideal_images(scene).value().blur()).error;
  if (error <= accurate_blur_error) return "";
  return fmt::format("defocus in the sheet blurs images so far that Gaussians deviate by {:.2g} % of the brightest one",
                     100 * error);
}

}  // namespace

std::string reason_against_pair_model(Setup const& setup) {
  if (std::string const reason = reason_against_ideal_images(setup); !reason.empty()) return reason;
  ParticleSetup const& particles = setup.piv->particles;
  if (particles.count == ParticleCount::file) return "the particles are read from a file";
  if (particles.diameter.spread == DiameterSpread::table) return "the diameters are read from a file";
  if (setup.sequence) return "the pairs of a sequence share their particles";
  if (!setup.camera.background.glare_file.empty()) return "the camera has a glare image";
  if (ParticleVelocity{setup.piv->flow.flow}.exact()) return "particles cross a shock";
  return reason_against_scattering(setup);
}

OwnedPairModel build_pair_model(Setup const& setup) {
  if (std::string const reason = reason_against_pair_model(setup); !reason.empty())
    throw DataError(ErrorCode::unsupported, KeyPath{"particles.scattering"},
                    "pairs cannot be rendered in batches (" + reason + ")");
  Scene scene = empty_scene(setup);
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
  IdealImages const ideal = build_ideal_images(scene).value();
  model.projection = ideal.projection();
  model.blur = ideal.blur();
  model.spot = {find_largest_blur(particles, model.sheet, model.blur).sigma};
  model.scattering = particles.scattering;
  std::shared_ptr<MieScattering const> mie;
  if (model.scattering == ParticleScattering::mie) {
    mie = tabulate_scattering(setup);
    model.mie = mie->view();
  }
  model.exposure = exposure_rule(camera);
  model.detector = Detector(camera, 0).pixel();
  return {model, flow.owner, std::move(mie)};
}

}  // namespace gladstone::inline ideal_images
