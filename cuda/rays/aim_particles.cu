#include "cuda/device/cuda_error.h"
#include "cuda/rays/trace_particles.h"

namespace gladstone::cuda::inline rays {
namespace {

constexpr int threads = 64;

/// Aims at the stop without the medium; not a template, so that all media share its code.
__device__ __noinline__ bool fill_straight(StopView const& stop, TracingOptions<double> const& tracing, Vec3d place,
                                           FilledStop& filled) {
  filled.map = paraxial_aim(stop, place);
  return fill_stop(stop, NoMedium<double>{}, tracing, place, filled);
}

/// Aims at the stop for one particle at one pulse.
/// @param placed  whether `origin` is already set
/// @param origin  set if `placed` is false
/// @param step  step of RaysLadder, which sets the number of rays; raised to the step that this pulse requires
template <class Medium>
__device__ void aim_pulse(StopView const& stop, ParticlesLaunch const& launch, LadderView const& ladder,
                          Medium const& medium, std::uint64_t i, int pulse, bool placed, PulseAim& aim, Vec2d& origin,
                          int& step) {
  auto const& particles = launch.pulses[pulse];
  if (!(particles.photons[i] > 0)) return;
  aim.state = AimState::unknown;
  if (stop.radius == 0) return;
  Vec3d const place = particles.middle(i);
  FilledStop straight;
  if (!fill_straight(stop, launch.tracing, place, straight)) return;
  FilledStop bent = straight;
  if constexpr (!std::is_same_v<Medium, NoMedium<double>>) {
    if (!fill_stop(stop, medium, launch.tracing, place, bent)) return;
  }
  aim.state = AimState::filled;
  aim.seen = bent.map;
  aim.ambient = straight.map;
  if (!placed) origin = sum_origin(straight);
  aim.low = bent.low;
  aim.high = bent.high;
  aim.spread2 = bent.spread2;
  double const weight = aimed_ray(launch, particles, aim.seen, i, {}).weight;
  int const first = ladder.step_filled(weight * ladder.light_per_photon, bent.spread2);
  step = first > step ? first : step;
}

template <class Medium>
__global__ void __launch_bounds__(threads)
    aim_particles_kernel(StopView const __grid_constant__ stop, ParticlesLaunch const __grid_constant__ launch,
                         LadderView const __grid_constant__ ladder, Medium const __grid_constant__ medium,
                         std::uint64_t const count, PulseAim* const aims, Vec2d* const origins,
                         ParticleSteps const steps) {
  std::uint64_t const i = std::uint64_t{blockIdx.x} * threads + threadIdx.x;
  if (i >= count) return;
  Vec2d origin{};
  bool placed = false;
  unsigned int missing = 0;
  int step = 0;
  GLADSTONE_RAY_BY_RAY
  for (int pulse = 0; pulse < frame_count; ++pulse) {
    PulseAim aim;
    aim_pulse(stop, launch, ladder, medium, i, pulse, placed, aim, origin, step);
    placed = placed || aim.state == AimState::filled;
    missing += aim.state == AimState::unknown ? 1 : 0;
    aims[frame_count * i + pulse] = aim;
  }
  origins[i] = origin;
  steps.step[i] = steps.next[i] = step;
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

void list_particles(LadderView const& ladder, PulseAim const* aims, int const* at, ParticleSteps const& steps,
                    std::uint64_t count, std::uint32_t* listed) {
  auto const blocks = static_cast<unsigned int>((count + threads - 1) / threads);
  list_particles_kernel<<<blocks, threads>>>(ladder.steps, aims, at, steps, count, listed);
  check_launch("list_particles");
}

void aim_particles(StopView const& stop, ParticlesLaunch const& launch, LadderView const& ladder,
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
