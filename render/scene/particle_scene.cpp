#include "render/scene/particle_scene.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/parallel.h"
#include "render/base/units.h"
#include "render/scene/build_camera.h"
#include "render/scene/light_through_lens.h"
#include "render/scene/read_setup.h"

namespace gladstone::inline scene {
namespace {

constexpr double bending_margin = 0.02;  // maximum deflection by media on the way to the lens [rad]

/// Returns the fraction of the particles' volume that the camera sees, sampled by low-discrepancy points: an additive
/// recurrence in X and Y (Roberts 2018: powers of the real root of x^3 = x + 1) and another one in Z.
double seen_share(Setup const& setup) {
  constexpr int places = 1 << 14;
  constexpr double root = 1.32471795724474602596, along_z = 0.41421356237309504880;
  Camera const camera = build_camera(setup);
  ParticleSetup const& particles = setup.piv->particles;
  std::vector<char> seen(places);
  parallel_chunks(places, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      auto const part = [i](double step) {
        double const x = 0.5 + static_cast<double>(i + 1) * step;
        return x - std::floor(x) - 0.5;
      };
      Vec3d const at{part(1 / root) * particles.volume->x, part(1 / (root * root)) * particles.volume->y,
                     part(along_z) * particles.volume->z};
      auto const pixel = camera.project(particles.center + at);
      seen[i] = pixel && camera.sensor.covers(*pixel) ? 1 : 0;
    }
  });
  return static_cast<double>(std::count(seen.begin(), seen.end(), 1)) / places;
}

/// Returns the range of scattering angles of light from all particles to the lens.
AngleInterval seen_angles(Scene const& scene) {
  LaserSheet<double> const sheet = laser_sheet(scene.setup.piv->laser);
  AngleInterval angles{pi, 0};
  Vec3d const lens = scene.camera.aim_plane.origin;
  for (int pulse = 0; pulse < 2; ++pulse) {
    for (Vec3d const& place : scene.particles.place[pulse]) {
      Vec3d const way = lens - place;
      double const far = length(way), cosine = dot(way, sheet.wave(place, pulse).propagation) / far;
      double const angle = std::acos(std::clamp(cosine, -1.0, 1.0));
      double const around = bending_margin + 1.5 * scene.imaging.entrance_pupil / far;
      angles = {std::min(angles.least, angle - around), std::max(angles.most, angle + around)};
    }
  }
  return {std::max(0.0, angles.least), std::min(pi, angles.most)};
}

/// @throws DataError if no particle is illuminated at either pulse
void require_light(Particles const& particles) {
  auto const lit = [&particles](int pulse) {
    return std::any_of(particles.photons[pulse].begin(), particles.photons[pulse].end(),
                       [](double p) { return p > 0; });
  };
  if (!lit(0) && !lit(1)) {
    throw DataError(ErrorCode::invalid_value, KeyPath{"laser"},
                    "illuminates no particle (none lies in the sheet at either pulse); check laser.offset_mm, "
                    "particles.volume_mm and center_mm, or seed more particles");
  }
}

/// Adds the scattering table of the scene's particles.
void add_scattering(Scene& scene) {
  PivSetup const& piv = *scene.setup.piv;
  if (piv.particles.scattering != ParticleScattering::mie) return;
  MieSetting const setting{piv.particles.index, piv.laser.wavelength, scene.setup.ambient_index()};
  scene.mie = std::make_shared<MieScattering const>(scene.particles.diameter, setting, seen_angles(scene));
}

/// Returns the photons of the brightest particle of the scene; 1 without particles.
double determine_photon_unit(Scene const& scene) {
  double const brightest = brightest_photons(scene, scene.particles, ParticleLight::scattered);
  return brightest > 0 ? brightest : 1;
}

/// Adds the particles of a pair of a sequence. The unit of light is that of the first pair, so that exposures and grey
/// levels of all pairs are comparable.
void add_particles_of_sequence(Scene& scene) {
  PivSetup& piv = *scene.setup.piv;
  auto const shared = scene.setup.shared_particles ? scene.setup.shared_particles : std::make_shared<ParticleCache>();
  if (!shared->sequence) {
    shared->flow_warnings = load_flow(piv.flow);
    double const count = piv.particles.count == ParticleCount::file ? 0 : particle_count(scene.setup);
    shared->sequence.emplace(piv.particles, count, piv.flow, laser_sheet(piv.laser),
                             path_tolerance_px * scene.setup.pixel_size());
  }
  piv.flow = shared->sequence->flow();
  scene.flow_warnings = shared->flow_warnings;
  auto const add_pair = [&](std::size_t pair) {
    scene.particles = shared->sequence->pair(pair);
    require_light(scene.particles);
    add_scattering(scene);
  };
  if (!(shared->photon_unit > 0)) {
    add_pair(0);
    shared->photon_unit = determine_photon_unit(scene);
  }
  std::size_t const pair = scene.setup.sequence->pair;
  if (pair > 0 || scene.particles.size() == 0) add_pair(pair);
  scene.photon_unit = shared->photon_unit;
}

}  // namespace

double particle_count(Setup const& setup) {
  ParticleSetup const& particles = setup.piv->particles;
  Vec3d const v = *particles.volume;
  switch (particles.count) {
    case ParticleCount::per_mm3:
      return particles.amount * v.x * v.y * v.z / std::pow(unit::millimetre, 3);
    case ParticleCount::per_pixel: {
      double const pixels = static_cast<double>(setup.camera.columns) * setup.camera.rows, share = seen_share(setup);
      if (!(share > 0))
        throw DataError(ErrorCode::invalid_value, KeyPath{"particles.volume_mm"},
                        "lies entirely outside the camera's view; check center_mm");
      return particles.amount * pixels / share;
    }
    case ParticleCount::number:
    case ParticleCount::file:
      break;
  }
  return particles.amount;
}

MemoryRequirement particle_memory(Setup const& setup) {
  ParticleSetup const& particles = setup.piv->particles;
  if (particles.count == ParticleCount::file) return {"particles.file", "particles", 0};
  char const* const key = particles.count == ParticleCount::per_mm3     ? "particles.per_mm3"
                          : particles.count == ParticleCount::per_pixel ? "particles.per_pixel"
                                                                        : "particles.number";
  double const margins = setup.sequence ? 4 : 2;  // pairs of a sequence are seeded at the first pulse, not at mid-time
  Vec3d const v = *particles.volume, wider = v + margins * motion_margin(setup.piv->flow, v, particles.center);
  double const share = wider.x * wider.y * wider.z / (v.x * v.y * v.z);
  return {key, "particles", particle_count(setup) * share * bytes_per_particle};
}

void add_particles(Scene& scene) {
  if (scene.setup.sequence) {
    add_particles_of_sequence(scene);
    return;
  }
  scene.flow_warnings = load_flow(scene.setup.piv->flow);
  PivSetup const& piv = *scene.setup.piv;
  LaserSheet<double> const sheet = laser_sheet(piv.laser);
  double const tolerance = path_tolerance_px * scene.setup.pixel_size();
  scene.particles = piv.particles.count == ParticleCount::file
                        ? read_particles(piv.particles, piv.flow, sheet, tolerance)
                        : seed_particles(piv.particles, particle_count(scene.setup), piv.flow, sheet, tolerance);
  require_light(scene.particles);
  add_scattering(scene);
  scene.photon_unit = determine_photon_unit(scene);
}

ParticleCensus count_particles(Scene const& scene) {
  constexpr double much = 0.1;
  ParticleCensus census;
  Particles const& particles = scene.particles;
  std::vector<char> in_view(particles.size());
  std::vector<double> moved_px(particles.size());
  parallel_chunks(particles.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      auto const first = scene.camera.project(particles.place[0][i]),
                 second = scene.camera.project(particles.place[1][i]);
      in_view[i] = first && scene.camera.sensor.covers(*first) ? 1 : 0;
      if (first && second) moved_px[i] = length(*second - *first);
    }
  });
  for (std::size_t i = 0; i < particles.size(); ++i) {
    double const first = particles.photons[0][i], second = particles.photons[1][i];
    census.lit[0] += first > 0 ? 1 : 0;
    census.lit[1] += second > 0 ? 1 : 0;
    if (!(first > 0) || in_view[i] == 0) continue;
    ++census.in_view;
    census.largest_px = std::max(census.largest_px, moved_px[i]);
    census.paired += second >= much * first ? 1 : 0;
  }
  return census;
}

}  // namespace gladstone::inline scene
