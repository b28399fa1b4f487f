#include "render/light/particle_motion.h"

#include <algorithm>

#include "render/base/parallel.h"
#include "render/light/particle_draw.h"

namespace gladstone::inline light {
namespace {

// number of particles from which the number of steps is chosen
constexpr std::size_t planned_paths = 1024;
constexpr int most_steps_of_path = 1 << 12;
constexpr double share_for_derivatives = 0.01;  // time step of derivatives, relative to dt

}  // namespace

ParticleVelocity particle_velocity(ParticleSetup const& setup, FlowSetup const& flow, double diameter) {
  return {flow.flow, setup.response_time(diameter), share_for_derivatives * flow.dt};
}

PathPlan plan_paths(ParticleSetup const& setup, FlowSetup const& flow, std::vector<Vec3d> const& start,
                    std::vector<double> const& diameter, double time, double tolerance) {
  std::size_t const count = std::min(start.size(), planned_paths);
  PathPlan plan;
  if (particle_velocity(setup, flow, 0).exact()) return plan;
  auto const particle = [&](std::size_t k) { return k * start.size() / count; };
  auto const ends = [&](int steps) {
    std::vector<Vec3d> found(count);
    parallel_chunks(count, 128, [&](std::size_t begin, std::size_t end) {
      for (std::size_t k = begin; k < end; ++k) {
        std::size_t const i = particle(k);
        found[k] = moved(particle_velocity(setup, flow, diameter[i]), start[i], time, steps);
      }
    });
    return found;
  };
  std::vector<Vec3d> coarse = ends(1);
  for (plan.steps = 2;; plan.steps *= 2) {
    std::vector<Vec3d> fine = ends(plan.steps);
    plan.error = 0;
    for (std::size_t k = 0; k < count; ++k) plan.error = std::max(plan.error, length(fine[k] - coarse[k]));
    if (plan.error <= tolerance || plan.steps >= most_steps_of_path) break;
    coarse = std::move(fine);
  }
  for (std::size_t k = 0; setup.density && k < count; ++k) {
    std::size_t const i = particle(k);
    plan.lag_error =
        std::max(plan.lag_error, flow.dt * length(particle_velocity(setup, flow, diameter[i]).neglected(start[i])));
  }
  return plan;
}

bool is_inside_volume(ParticleSetup const& setup, Vec3d place) {
  return !setup.volume || is_inside_box(place, setup.center, *setup.volume);
}

void light_particles(ParticleSetup const& setup, LaserSheet<double> const& sheet, Particles& particles) {
  for (int pulse = 0; pulse < 2; ++pulse) {
    particles.photons[pulse].resize(particles.size());
    parallel_chunks(particles.size(), 4096, [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i) {
        Vec3d const p = particles.place[pulse][i];
        particles.photons[pulse][i] = is_inside_volume(setup, p) ? sheet.photons(p, pulse) : 0.0;
      }
    });
  }
}

double draws_per_particle(ParticleSetup const& setup, FlowSetup const& flow) {
  return flow.flow.kind.visit([&](auto const& held) {
    if constexpr (requires { held.most_crowding(); }) {
      double const tau = setup.response_time(setup.diameter.middle);
      return held.most_crowding() / held.mean_crowding(*setup.volume, setup.center, tau);
    }
    return 1.0;
  });
}

bool crowds_here(Flow const& flow, Vec3d place, double tau, KeyedEngine& engine) {
  return flow.kind.visit([&](auto const& held) {
    if constexpr (requires { held.most_crowding(); }) {
      return to_unit(engine()) * held.most_crowding() < held.crowding(place, tau);
    }
    return true;
  });
}

std::size_t count_outside(FlowSetup const& flow, Particles const& particles) {
  std::size_t count = 0;
  for (std::size_t i = 0; flow.file && i < particles.size(); ++i) {
    bool const inside = velocity_known(flow, particles.place[0][i]) && velocity_known(flow, particles.place[1][i]);
    count += inside ? 0 : 1;
  }
  return count;
}

}  // namespace gladstone::inline light
