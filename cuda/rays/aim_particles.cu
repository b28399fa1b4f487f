#include "cuda/device/cuda_error.h"
#include "cuda/rays/trace_particles.h"

namespace gladstone::cuda {
namespace {

constexpr int threads = 64;

/// Without the medium: one function for all media.
__device__ __noinline__ bool fill_straight(StopView const& stop, TracingOptions<double> const& tracing, Vec3d place,
                                           FilledStop& filled) {
  filled.map = paraxial_aim(stop, place);
  return fill_stop(stop, NoMedium<double>{}, tracing, place, filled);
}

/// Aims for one particle at one pulse. @param origin is set where it is not known yet
template <class Medium>
__device__ void aim_pulse(StopView const& stop, ParticlesLaunch const& launch, Medium const& medium, std::uint64_t i,
                          int pulse, bool placed, PulseAim& aim, Vec2d& origin) {
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
  if (!placed) origin = origin_of(straight);
  if (launch.most_window_px > 0) aim.most_weight = weight_expected(launch, particles, aim.seen, i);
  place_window(launch, bent.low, bent.high, aim);
}

template <class Medium>
__global__ void __launch_bounds__(threads)
    aim_particles_kernel(StopView const __grid_constant__ stop, ParticlesLaunch const __grid_constant__ launch,
                         Medium const __grid_constant__ medium, std::uint64_t const count, PulseAim* const aims,
                         Vec2d* const origins, unsigned long long* const unknown) {
  std::uint64_t const i = std::uint64_t{blockIdx.x} * threads + threadIdx.x;
  if (i >= count) return;
  Vec2d origin{};
  bool placed = false;
  unsigned int missing = 0;
  GLADSTONE_RAY_BY_RAY
  for (int pulse = 0; pulse < frame_count; ++pulse) {
    PulseAim aim;
    aim_pulse(stop, launch, medium, i, pulse, placed, aim, origin);
    placed = placed || aim.state == AimState::filled;
    missing += aim.state == AimState::unknown ? 1 : 0;
    aims[frame_count * i + pulse] = aim;
  }
  origins[i] = origin;
  if (missing > 0) atomicAdd(unknown, static_cast<unsigned long long>(missing));
}

}  // namespace

void aim_particles(StopView const& stop, ParticlesLaunch const& launch, DeviceMedium<double> const& medium,
                   std::uint64_t count, PulseAim* aims, Vec2d* origins, unsigned long long* unknown) {
  auto const blocks = static_cast<unsigned int>((count + threads - 1) / threads);
  std::visit(
      [&](auto const& held) {
        aim_particles_kernel<<<blocks, threads>>>(stop, launch, held, count, aims, origins, unknown);
        check_launch("aim_particles");
      },
      medium);
}

}  // namespace gladstone::cuda
