#pragma once

#include "cuda/rays/trace_particles.h"

namespace gladstone::cuda::inline rays {

/// Traces ray j of a particle at one pulse. @param key  key of the particle's random numbers
template <class Medium>
__device__ ParticleRays<1> trace_particle_ray(ParticlesLaunch const& launch, CameraView<double> const& camera,
                                              Medium const& medium, PulseAim const& aim, int pulse,
                                              std::uint64_t particle, std::uint64_t key, std::uint64_t j) {
  StopRuleView const rule = aim.state == AimState::filled ? launch.rule : StopRuleView{};
  StopSamplePoint const to[1] = {sample_stop_point(rule, launch.choice, key, j)};
  auto const aimed_by = [&](AimMap const& map) {
    return [&](Vec2d at) { return aimed_ray(launch, launch.pulses[pulse], map, particle, at); };
  };
  return trace_particle_rays(camera, medium, launch.tracing, to, aimed_by(aim.seen), aimed_by(aim.ambient));
}

/// Stores the larger of two non-negative squares atomically.
__device__ inline void keep_largest(double* largest, double square) {
  atomicMax(reinterpret_cast<unsigned long long*>(largest),
            static_cast<unsigned long long>(__double_as_longlong(square)));
}

/// Adds a block's counts of ray statuses to the totals. Must be called by all threads of the block.
/// @param counts  [pulse][status]
__device__ inline void add_ends(ParticlesLaunch const& launch, unsigned int const* counts, unsigned long long* ends) {
  __syncthreads();
  if (threadIdx.x < frame_count * ray_status_count && counts[threadIdx.x] > 0) {
    auto const more = static_cast<long long>(counts[threadIdx.x]);
    // negative counts rely on unsigned wrap-around
    atomicAdd(ends + threadIdx.x, static_cast<unsigned long long>(launch.sign < 0 ? -more : more));
  }
}

}  // namespace gladstone::cuda::inline rays
