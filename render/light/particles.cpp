#include "render/light/particles.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/error.h"
#include "render/base/parallel.h"
#include "render/base/progress.h"
#include "render/base/units.h"
#include "render/files/text_file.h"
#include "render/light/number_table.h"
#include "render/light/particle_draw.h"
#include "render/light/particle_motion.h"

namespace gladstone::inline light {
namespace {

/// Diameters of a table, with their cumulative weights.
struct DiameterTable {
  std::vector<double> diameter, up_to;

  explicit DiameterTable(std::string const& path) {
    double sum = 0;
    for (NumberTable file(path, "a table of diameters", {"diameter_um", "weight"}); auto const row = file.next();) {
      if (!((*row)[0] > 0))
        throw DataError(ErrorCode::out_of_range, file.place(), "the diameter is not positive; remove the line");
      if (!((*row)[1] >= 0))
        throw DataError(ErrorCode::out_of_range, file.place(),
                        "the weight is negative (weights are shares of the particles); give 0 or more");
      diameter.push_back((*row)[0] * unit::micrometre);
      up_to.push_back(sum += (*row)[1]);
    }
    if (!(sum > 0))
      throw DataError(ErrorCode::missing_content, path,
                      "contains no diameter with a weight (one line diameter_um,weight is needed for each)");
  }
  double at(double share) const {
    auto const found = std::upper_bound(up_to.begin(), up_to.end(), share * up_to.back());
    return diameter[std::min(static_cast<std::size_t>(found - up_to.begin()), diameter.size() - 1)];
  }
};

}  // namespace

void Particles::resize(std::size_t count) {
  for (int pulse = 0; pulse < 2; ++pulse) {
    place[pulse].resize(count);
    photons[pulse].resize(count);
  }
  diameter.resize(count);
}

void Particles::copy(std::size_t from, std::size_t to) {
  for (int pulse = 0; pulse < 2; ++pulse) {
    place[pulse][to] = place[pulse][from];
    photons[pulse][to] = photons[pulse][from];
  }
  diameter[to] = diameter[from];
}

Vec3d motion_margin(FlowSetup const& flow, Vec3d volume, Vec3d center) {
  constexpr int nodes = 33;
  Vec3d most{};
  for (int k = 0; k < nodes * nodes * nodes; ++k) {
    int const x = k % nodes, y = k / nodes % nodes, z = k / nodes / nodes;
    Vec3d const at{x - 16.0, y - 16.0, z - 16.0};
    Vec3d const u = flow.flow(center + Vec3d{volume.x * at.x, volume.y * at.y, volume.z * at.z} / (nodes - 1.0));
    most = {std::max(most.x, std::abs(u.x)), std::max(most.y, std::abs(u.y)), std::max(most.z, std::abs(u.z))};
  }
  flow.flow.kind.visit([&most](auto const& held) {
    if constexpr (requires { held.fastest(); }) {
      Vec3d const u = held.fastest();
      most = {std::max(most.x, std::abs(u.x)), std::max(most.y, std::abs(u.y)), std::max(most.z, std::abs(u.z))};
    }
  });
  return (1.25 * flow.dt / 2) * most;
}

std::vector<double> draw_diameters(DiameterSetup const& setup, std::uint64_t seed, std::size_t count) {
  std::vector<double> diameters(count, setup.middle);
  if (setup.spread == DiameterSpread::one) return diameters;
  std::optional<DiameterTable> table;
  if (setup.spread == DiameterSpread::table) table.emplace(setup.file);
  parallel_chunks(count, 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      KeyedEngine engine = size_engine(seed, i);
      diameters[i] =
          table ? table->at(to_unit(engine())) : draw_diameter(setup.spread, setup.middle, setup.width, engine);
    }
  });
  return diameters;
}

SeedingPlan plan_seeding(ParticleSetup const& setup, double count, FlowSetup const& flow) {
  Vec3d const volume = *setup.volume;
  Vec3d const wider = volume + 2.0 * motion_margin(flow, volume, setup.center);
  double const share = wider.x * wider.y * wider.z / (volume.x * volume.y * volume.z);
  return {wider, static_cast<std::size_t>(std::llround(count * share * draws_per_particle(setup, flow)))};
}

Particles seed_particles(ParticleSetup const& setup, double count, FlowSetup const& flow,
                         LaserSheet<double> const& sheet, double tolerance) {
  auto const [wider, seeded] = plan_seeding(setup, count, flow);
  Particles particles;
  particles.resize(seeded);
  particles.diameter = draw_diameters(setup.diameter, setup.seed, seeded);
  std::vector<Vec3d>& middle = particles.place[0];
  Vec3d const box = wider;
  std::vector<char> wanted(seeded);
  parallel_chunks(seeded, 4096, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      KeyedEngine engine(setup.seed, RandomStream::particles, i);
      middle[i] = draw_place(engine, setup.center, box);
      wanted[i] = crowds_here(flow.flow, middle[i], setup.response_time(particles.diameter[i]), engine) ? 1 : 0;
    }
  });
  particles.path = plan_paths(setup, flow, middle, particles.diameter, flow.dt / 2, tolerance);
  Progress progress("moving particles", seeded);
  parallel_chunks(seeded, 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      ParticleVelocity const velocity = particle_velocity(setup, flow, particles.diameter[i]);
      particles.place[1][i] = moved(velocity, middle[i], flow.dt / 2, particles.path.steps);
      middle[i] = moved(velocity, middle[i], -flow.dt / 2, particles.path.steps);
    }
    progress.advance(end - begin);
  });
  light_particles(setup, sheet, particles);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < seeded; ++i) {
    if (wanted[i] == 0) continue;
    if (particles.photons[0][i] > 0 || particles.photons[1][i] > 0) particles.copy(i, kept++);
  }
  particles.resize(kept);
  particles.outside_flow = count_outside(flow, particles);
  return particles;
}

Particles read_particles(ParticleSetup const& setup, FlowSetup const& flow, LaserSheet<double> const& sheet,
                         double tolerance) {
  Particles particles;
  NumberTable file(setup.file, "a table of particles", {"x_mm", "y_mm", "z_mm", "diameter_um"});
  while (auto const row = file.next()) {
    if (!((*row)[3] > 0)) {
      throw DataError(ErrorCode::out_of_range, file.place(),
                      fmt::format("the diameter is {:.6g} um (it must be positive); correct it, or remove the particle",
                                  (*row)[3]));
    }
    require_room(particles.diameter, setup.file, "particles");
    particles.place[0].push_back(Vec3d{(*row)[0], (*row)[1], (*row)[2]} * unit::millimetre);
    particles.diameter.push_back((*row)[3] * unit::micrometre);
  }
  if (particles.diameter.empty()) {
    throw DataError(ErrorCode::missing_content, setup.file,
                    "contains no particles (one line x_mm,y_mm,z_mm,diameter_um is needed for each)");
  }
  std::vector<Vec3d> const& start = particles.place[0];
  particles.path = plan_paths(setup, flow, start, particles.diameter, flow.dt, tolerance);
  particles.place[1].resize(particles.size());
  parallel_chunks(particles.size(), 256, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      particles.place[1][i] =
          moved(particle_velocity(setup, flow, particles.diameter[i]), start[i], flow.dt, particles.path.steps);
    }
  });
  light_particles(setup, sheet, particles);
  particles.outside_flow = count_outside(flow, particles);
  return particles;
}

}  // namespace gladstone::inline light
