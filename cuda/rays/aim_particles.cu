#include "cuda/device/cuda_error.h"
#include "cuda/rays/trace_particles.h"

namespace gladstone::cuda::inline rays {
namespace {

constexpr int threads = 64;

template <class Medium>
__global__ void __launch_bounds__(threads)
    aim_particles_kernel(StopView const __grid_constant__ stop, ParticlesLaunch const __grid_constant__ launch,
                         ParticleLadder const __grid_constant__ ladder, Medium const __grid_constant__ medium,
                         std::uint64_t const count, PulseAim* const aims, Vec2d* const origins,
                         ParticleSteps const steps) {
  std::uint64_t const i = std::uint64_t{blockIdx.x} * threads + threadIdx.x;
  if (i >= count) return;
  ParticleStart start;
  unsigned int missing = 0;
  GLADSTONE_RAY_BY_RAY
  for (int pulse = 0; pulse < frame_count; ++pulse) {
    PulseAim const aim =
        aim_pulse(stop, launch.tracing, medium, launch.pulses[pulse], i, ladder, ladder.light_per_photon, start);
    missing += aim.state == AimState::unknown ? 1 : 0;
    aims[frame_count * i + pulse] = aim;
  }
  origins[i] = start.origin;
  steps.step[i] = steps.next[i] = start.step;
  steps.chosen[i] = missing == 0 ? 1 : 0;
  if (missing > 0) atomicAdd(steps.count + LadderView::max_step_count, missing);
}

__global__ void __launch_bounds__(threads)
    list_particles_kernel(int const most, PulseAim const* const aims, int const* const at, ParticleSteps const steps,
                          std::uint64_t const count, std::uint32_t* const listed) {
  std::uint64_t const i = std::uint64_t{blockIdx.x} * threads + threadIdx.x;
  if (i >= count || steps.chosen[i] == 0) return;
  int const step = at[i];
  if (step >= most) return;
  for (std::uint64_t k = frame_count * i; k < frame_count * (i + 1); ++k) {
    if (aims[k].state != AimState::filled) continue;
    unsigned int const place = atomicAdd(steps.count + step, 1u);
    listed[static_cast<std::uint64_t>(step) * frame_count * count + place] = static_cast<std::uint32_t>(k);
  }
}

}  // namespace

void list_particles(ParticleLadder const& ladder, PulseAim const* aims, int const* at, ParticleSteps const& steps,
                    std::uint64_t count, std::uint32_t* listed) {
  auto const blocks = static_cast<unsigned int>((count + threads - 1) / threads);
  list_particles_kernel<<<blocks, threads>>>(ladder.steps, aims, at, steps, count, listed);
  check_launch("list_particles");
}

void aim_particles(StopView const& stop, ParticlesLaunch const& launch, ParticleLadder const& ladder,
                   DeviceMedium const& medium, std::uint64_t count, PulseAim* aims, Vec2d* origins,
                   ParticleSteps const& steps) {
  auto const blocks = static_cast<unsigned int>((count + threads - 1) / threads);
  std::visit(
      [&](auto const& held) {
        aim_particles_kernel<<<blocks, threads>>>(stop, launch, ladder, held, count, aims, origins, steps);
        check_launch("aim_particles");
      },
      medium);
}

}  // namespace gladstone::cuda::inline rays
