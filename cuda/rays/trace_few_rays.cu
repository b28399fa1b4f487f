#include "cuda/device/launch.h"
#include "cuda/rays/particle_ray.cuh"
#include "cuda/rays/warp_spots.cuh"

namespace gladstone::cuda::inline rays {
namespace {

constexpr int threads = 128, warps = threads / warp_size;

/// Sums over those lanes of a particle whose rays belong to one scrambling, in an order that depends only on the number
/// of lanes.
__device__ void sum_lanes(RaySums& sums, int lanes, int scramblings) {
  auto const from = [](auto value, int step) { return __shfl_xor_sync(whole_warp, value, step); };
  for (int step = lanes / 2; step >= scramblings; step /= 2) {
    for (CentroidSum<double>& sum : sums.hits) {
      CentroidSum<double> other;
      other.weight = from(sum.weight, step);
      other.first = {from(sum.first.x, step), from(sum.first.y, step)};
      other.second = {from(sum.second.x, step), from(sum.second.y, step)};
      other.count = from(sum.count, step);
      sum += other;
    }
  }
}

GLADSTONE_HD std::size_t elements_bytes(ParticlesLaunch const& launch) {
  static_assert(sizeof(CameraElement<double>) % 16 == 0);
  return static_cast<std::size_t>(launch.camera.count) * sizeof(CameraElement<double>);
}

/// Traces particles with few rays, warp_size / lanes of them per warp.
template <class Medium>
__global__ void __launch_bounds__(threads, 4)
    trace_few_rays_kernel(ParticlesLaunch const __grid_constant__ launch, Medium const __grid_constant__ medium,
                          AimState const state, PulseAim const* const aims, Vec2d const* const origins,
                          std::uint32_t const* const listed, std::uint64_t const count, ParticlesTraced const traced) {
  extern __shared__ __align__(16) unsigned char dynamic[];
  __shared__ unsigned int counts[frame_count * ray_status_count];
  CameraView<double> camera = launch.camera;
  camera.elements = reinterpret_cast<CameraElement<double>*>(dynamic);
  for (std::size_t i = threadIdx.x; i < elements_bytes(launch) / sizeof(double); i += threads) {
    reinterpret_cast<double*>(dynamic)[i] = reinterpret_cast<double const*>(launch.camera.elements)[i];
  }
  if (threadIdx.x < frame_count * ray_status_count) counts[threadIdx.x] = 0;
  __syncthreads();
  int const lane = threadIdx.x % warp_size, lanes = launch.lanes(), ray_of_lane = lane % lanes;
  auto const of_warp = static_cast<std::uint64_t>(warp_size / lanes);
  WarpSpots const spots(dynamic + elements_bytes(launch) + threadIdx.x / warp_size * WarpSpots::bytes(launch.patch_px),
                        launch.patch_px);
  std::uint64_t first = (std::uint64_t{blockIdx.x} * warps + threadIdx.x / warp_size) * of_warp;
  for (; first < count; first += std::uint64_t{gridDim.x} * warps * of_warp) {
    std::uint64_t const place = first + static_cast<std::uint64_t>(lane / lanes);
    std::uint64_t const at = listed[place < count ? place : first], particle = at / frame_count;
    int const pulse = static_cast<int>(at % frame_count);
    PulseAim const& aim = aims[at];
    bool const mine = place < count && aim.state == state;
    LightSquare const square = mine ? light_square(launch, aim) : LightSquare{};
    std::uint64_t const key = launch.pulses[0].key(particle);
    RaySums sums;
    double moved2 = 0;
    for (std::uint64_t from = 0; from < launch.rays; from += static_cast<std::uint64_t>(lanes)) {
      std::uint64_t const j = from + static_cast<std::uint64_t>(ray_of_lane);
      ParticleRays<1> ray;
      if (mine && j < launch.rays) {
        ray = trace_particle_ray(launch, camera, medium, aim, pulse, particle, key, j);
        ray.enter(0, origins[particle], sums.hits[0], sums.hits[1]);
        moved2 = fmax(moved2, ray.deflection2[0]);
        atomicAdd(counts + pulse * ray_status_count + static_cast<int>(ray.seen[0].status), 1u);
      }
      if (launch.patch_px == 0) continue;
      RayHit<double> const& seen = ray.seen[0];
      double const units = launch.sign * seen.weight * launch.images.units_per_weight;
      bool const alone =
          !spots.accumulate_light(launch.spot, square, seen.pixel, units, lanes, pulse, launch.images) && units != 0;
      add_psfs(launch, alone, seen, pulse);
    }
    if (moved2 > 0 && state == AimState::wide) keep_largest(traced.moved2 + at, moved2);
    sum_lanes(sums, lanes, launch.scramblings());
    if (mine && ray_of_lane < launch.scramblings()) traced.sums[at * launch.sums_per_pulse + ray_of_lane] = sums;
  }
  add_ends(launch, counts, traced.ends);
}

}  // namespace

void trace_few_rays(ParticlesLaunch const& launch, DeviceMedium const& medium, AimState state, PulseAim const* aims,
                    Vec2d const* origins, std::uint32_t const* listed, std::uint64_t count,
                    ParticlesTraced const& traced) {
  std::visit(
      [&](auto const& held) {
        auto* const kernel = trace_few_rays_kernel<std::remove_cvref_t<decltype(held)>>;
        std::size_t const shared = elements_bytes(launch) + warps * WarpSpots::bytes(launch.patch_px);
        auto const of_block = static_cast<std::uint64_t>(threads / launch.lanes());
        allow_shared_bytes(kernel, shared);
        kernel<<<blocks_for(kernel, threads, shared, (count + of_block - 1) / of_block), threads, shared>>>(
            launch, held, state, aims, origins, listed, count, traced);
        check_launch("trace_few_rays");
      },
      medium);
}

}  // namespace gladstone::cuda::inline rays
