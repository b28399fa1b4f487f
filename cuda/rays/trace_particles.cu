#include "cuda/device/block_sum.cuh"
#include "cuda/device/launch.h"
#include "cuda/rays/add_psf.cuh"
#include "cuda/rays/hit_window.cuh"
#include "cuda/rays/particle_ray.cuh"

namespace gladstone::cuda::inline rays {
namespace {

constexpr int threads = source_threads;

/// Part of a particle's rays at one pulse that is traced by one block.
struct BlockShare {
  std::uint64_t particle;  ///< index of the particle in the batch
  int pulse;
  std::uint64_t first, last;  ///< range of the particle's rays
  std::uint64_t key;          ///< key of the particle's random numbers
  Vec2d origin;
};

/// Estimates the weight of the heaviest ray in a window. Must be called by all threads of the block.
__device__ double weight_expected(ParticlesLaunch const& launch, PulseAim const& aim, BlockShare const& share) {
  __shared__ unsigned long long heaviest;
  if (threadIdx.x == 0) heaviest = 0;
  __syncthreads();
  if (threadIdx.x <= rim_rays) {
    double const weight = weight_of_rim(launch, aim, share.pulse, share.particle, static_cast<int>(threadIdx.x));
    if (weight > 0) atomicMax(&heaviest, static_cast<unsigned long long>(__double_as_longlong(weight)));
  }
  __syncthreads();
  return heavier_in_window * __longlong_as_double(static_cast<long long>(heaviest));
}

/// Traces the rays of a block's share. Rays through the medium are counted and contribute light; sums are taken with
/// and without the medium.
template <class Medium>
__device__ void trace_share(ParticlesLaunch const& launch, CameraView<double> const& camera, Medium const& medium,
                            PulseAim const& aim, BlockShare const& share, HitWindow const& window, unsigned int* counts,
                            RaySums& sums, double& moved2) {
  bool const lit = launch.images.light[0] != nullptr;
  // Whole warps take part in every iteration, because add_psfs() is collective.
  for (std::uint64_t of_block = share.first; of_block < share.last; of_block += threads) {
    std::uint64_t const j = of_block + threadIdx.x;
    ParticleRays<1> ray;
    RayHit<double> const& seen = ray.seen[0];
    // true: the window of spline nodes did not accept the ray, whose PSF is added directly to the image
    bool alone = false;
    if (j < share.last) {
      ray = trace_particle_ray(launch, camera, medium, aim, share.pulse, share.particle, share.key, j);
      ray.enter(0, share.origin, sums.hits[0], sums.hits[1]);
      moved2 = fmax(moved2, ray.deflection2[0]);
      atomicAdd(counts + share.pulse * ray_status_count + static_cast<int>(seen.status), 1u);
      alone = lit && seen.weight != 0 && !window.take(seen.pixel, seen.weight);
    }
    if (lit) add_psfs(launch, alone, seen, share.pulse);
  }
}

template <class Medium>
__global__ void __launch_bounds__(threads, 3)
    trace_particles_kernel(ParticlesLaunch const __grid_constant__ launch, Medium const __grid_constant__ medium,
                           AimState const state, PulseAim const* const aims, Vec2d const* const origins,
                           std::uint32_t const* const listed, std::uint64_t const count, ParticlesTraced const traced) {
  extern __shared__ __align__(16) unsigned char dynamic[];
  __shared__ unsigned int counts[frame_count * ray_status_count];
  SharedParts const parts(dynamic, launch, threads);
  if (threadIdx.x < frame_count * ray_status_count) counts[threadIdx.x] = 0;
  parts.fill(launch, threads);
  __syncthreads();
  CameraView<double> camera = launch.camera;
  camera.elements = parts.elements;
  HitSplineView spline = launch.spline;
  spline.share = parts.share;
  std::uint64_t const shares = launch.shares();
  unsigned int const scramblings = launch.scramblings();
  for (std::uint64_t item = blockIdx.x; item < count * shares; item += gridDim.x) {
    std::uint64_t const at = listed[item / shares], part = item % shares;
    PulseAim const& aim = aims[at];
    if (aim.state != state) continue;
    std::uint64_t const first = part * ParticlesLaunch::max_rays_per_block, particle = at / frame_count;
    BlockShare const share{particle,
                           static_cast<int>(at % frame_count),
                           first,
                           min(launch.rays, first + ParticlesLaunch::max_rays_per_block),
                           launch.pulses[0].key(particle),
                           origins[particle]};
    HitWindow window;
    LightSquare const square = light_square(launch, aim);
    if (parts.nodes != nullptr && square.side > 0) {
      double const most_weight = weight_expected(launch, aim, share);
      window = {parts.nodes,
                square.side * spline.per_px,
                spline.per_px,
                square.left,
                square.top,
                HitWindow::units_per_weight(most_weight, min(launch.rays, ParticlesLaunch::max_rays_per_block)),
                most_weight};
      window.clear();
    }
    __syncthreads();
    RaySums sums;
    double moved2 = 0;
    trace_share(launch, camera, medium, aim, share, window, counts, sums, moved2);
    if (moved2 > 0 && state == AimState::wide) keep_largest(traced.moved2 + at, moved2);
    __syncthreads();
    block_sums(sums, parts.sums, scramblings);
    if (threadIdx.x < scramblings) {
      traced.sums[at * launch.sums_per_pulse + part * scramblings + threadIdx.x] = parts.sums[threadIdx.x];
    }
    __syncthreads();
    if (window.nodes) window.flush(spline, parts.rows_seen, launch.images, share.pulse, launch.sign);
  }
  add_ends(launch, counts, traced.ends);
}

constexpr int seeing_threads = 64;

__global__ void __launch_bounds__(seeing_threads)
    see_particles_kernel(ParticleLadder const __grid_constant__ ladder, PulseAim const* const aims,
                         Vec2d const* const origins, RaySums const* const sums, std::uint64_t const count,
                         ParticleSteps const steps, DotTruth* const truth, DotTruth* const ambient) {
  std::uint64_t const i = std::uint64_t{blockIdx.x} * seeing_threads + threadIdx.x;
  if (i >= count) return;
  RaySums through_medium[most_scramblings], without[most_scramblings];
  int const step = steps.step[i] = steps.next[i];
  int const scramblings = 1 << ladder.scrambling_bits[step];
  std::uint64_t const shares = ParticlesLaunch::shares_of(ladder.rays[step]);
  for (int pulse = 0; pulse < frame_count; ++pulse) {
    std::uint64_t const at = frame_count * i + pulse;
    AimState const state = aims[at].state;
    if (state != AimState::filled && state != AimState::wide) continue;
    for (std::uint64_t share = 0; share < shares; ++share) {
      for (int k = 0; k < scramblings; ++k) {
        RaySums const& here = sums[at * ladder.sums_per_pulse + share * scramblings + k];
        through_medium[k].hits[pulse] += here.hits[0];
        if (ambient) without[k].hits[pulse] += here.hits[1];
      }
    }
  }
  steps.next[i] = next_particle_step(ladder, step, aims + frame_count * i, through_medium, ladder.light_per_photon);
  steps.chosen[i] = steps.next[i] > step ? 1 : 0;
  if (steps.chosen[i] != 0) atomicAdd(steps.count + LadderView::max_step_count, 1u);
  truth[i] = source_truth(through_medium, scramblings, origins[i]);
  if (ambient) ambient[i] = source_truth(without, scramblings, origins[i]);
}

}  // namespace

int widest_particle_window_px(ParticlesLaunch const& launch, DeviceMedium const& medium) {
  std::size_t const there = std::visit(
      [](auto const& held) { return most_shared_bytes(trace_particles_kernel<std::remove_cvref_t<decltype(held)>>); },
      medium);
  constexpr std::size_t most_bytes = 64 * 1024;
  constexpr int most_nodes = 88;
  if (!launch.spline.share || there < most_bytes) return 0;
  ParticlesLaunch probe = launch;
  for (probe.most_window_px = most_nodes / launch.spline.per_px; probe.most_window_px > 0; --probe.most_window_px) {
    if (SharedParts::bytes(probe, threads) <= most_bytes) break;
  }
  return probe.most_window_px;
}

void trace_particles(ParticlesLaunch const& launch, DeviceMedium const& medium, AimState state, PulseAim const* aims,
                     Vec2d const* origins, std::uint32_t const* listed, std::uint64_t count,
                     ParticlesTraced const& traced) {
  if (launch.few_rays()) return trace_few_rays(launch, medium, state, aims, origins, listed, count, traced);
  std::visit(
      [&](auto const& held) {
        auto* const kernel = trace_particles_kernel<std::remove_cvref_t<decltype(held)>>;
        std::size_t const shared = SharedParts::bytes(launch, threads);
        allow_shared_bytes(kernel, shared);
        kernel<<<blocks_for(kernel, threads, shared, count * launch.shares()), threads, shared>>>(
            launch, held, state, aims, origins, listed, count, traced);
        check_launch("trace_particles");
      },
      medium);
}

void see_particles(ParticleLadder const& ladder, PulseAim const* aims, Vec2d const* origins, RaySums const* sums,
                   std::uint64_t count, ParticleSteps const& steps, DotTruth* truth, DotTruth* ambient) {
  auto const blocks = static_cast<unsigned int>((count + seeing_threads - 1) / seeing_threads);
  see_particles_kernel<<<blocks, seeing_threads>>>(ladder, aims, origins, sums, count, steps, truth, ambient);
  check_launch("see_particles");
}

}  // namespace gladstone::cuda::inline rays
