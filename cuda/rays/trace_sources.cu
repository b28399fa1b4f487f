#include "cuda/device/block_sum.cuh"
#include "cuda/device/launch.h"
#include "cuda/rays/add_psf.cuh"
#include "cuda/rays/hit_window.cuh"

namespace gladstone::cuda::inline rays {
namespace {

constexpr int threads = source_threads;

/// Traces one block's share of a source.
template <class Medium>
__device__ void trace_share(SourcesLaunch const& launch, CameraView<double> const& camera, Medium const& medium,
                            SourceOnDevice const& aim, std::uint64_t first, std::uint64_t last,
                            HitWindow const (&window)[frame_count], unsigned int* counts, RaySums& sums,
                            double& moved2) {
  bool const lit = launch.images.light[0] != nullptr;
  AimedBundle<double> const bundle{aim.centre, aim.a, aim.b, aim.across, launch.choice, aim.by_x, aim.by_y};
  auto const count = [counts](int frame, RayStatus status) {
    atomicAdd(counts + frame * ray_status_count + static_cast<int>(status), 1u);
  };
  // Whole warps take part in every iteration, because add_psfs() is collective.
  for (std::uint64_t of_block = first; of_block < last; of_block += threads) {
    std::uint64_t const j = of_block + threadIdx.x;
    RayHit<double> hit[frame_count];
    // true: the window of spline nodes did not accept the ray, whose PSF is added directly to the image
    bool alone[frame_count] = {};
    if (j < last) {
      AimedRay<double> const aimed = aim_ray(launch.sources, bundle, aim.source, j);
      hit[0] = trace_ray(camera, NoMedium<double>{}, launch.tracing, aimed.ray, aimed.weight);
      hit[1] = trace_ray(camera, medium, launch.tracing, aimed.ray, aimed.weight);
      double const here2 =
          enter_ray(hit[0], hit[1], aim.origin, sums.hits, count, [&](int frame, RayHit<double> const& here) {
            alone[frame] = lit && !window[frame].take(here.pixel, here.weight);
          });
      moved2 = fmax(moved2, here2);
    }
    if (lit) {
      for (int frame = 0; frame < frame_count; ++frame) add_psfs(launch, alone[frame], hit[frame], frame);
    }
  }
}

template <class Medium>
__global__ void __launch_bounds__(threads, 3)
    trace_sources_kernel(SourcesLaunch const __grid_constant__ launch, Medium const __grid_constant__ medium,
                         SourceOnDevice const* const sources, std::uint64_t const count, SourcesTraced const traced) {
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
  std::uint64_t const shares = (launch.rays + max_rays_per_share - 1) / max_rays_per_share;
  unsigned int const scramblings = 1u << launch.choice.scrambling_bits;
  for (std::uint64_t item = blockIdx.x; item < count * shares; item += gridDim.x) {
    std::uint64_t const at = item / shares, first = item % shares * max_rays_per_share;
    std::uint64_t const last = min(launch.rays, first + max_rays_per_share);
    SourceOnDevice const& aim = sources[at];
    double const units = HitWindow::units_per_weight(aim.most_weight, min(launch.rays, max_rays_per_share));
    HitWindow window[frame_count];
    bool const windows = parts.nodes != nullptr && aim.window_px > 0;
    int const side = aim.window_px * spline.per_px;
    for (int frame = 0; windows && frame < frame_count; ++frame) {
      window[frame] = {parts.nodes + frame * side * side,
                       side,
                       spline.per_px,
                       aim.left[frame],
                       aim.top[frame],
                       units,
                       aim.most_weight};
      window[frame].clear();
    }
    __syncthreads();
    RaySums sums;
    double moved2 = 0;
    trace_share(launch, camera, medium, aim, first, last, window, counts, sums, moved2);
    for (int step = warp_size / 2; step > 0; step /= 2)
      moved2 = fmax(moved2, __shfl_xor_sync(whole_warp, moved2, step));
    if (threadIdx.x % warp_size == 0 && moved2 > 0) {
      atomicMax(reinterpret_cast<unsigned long long*>(traced.moved2 + at),
                static_cast<unsigned long long>(__double_as_longlong(moved2)));
    }
    __syncthreads();
    block_sums(sums, parts.sums, scramblings);
    if (threadIdx.x < scramblings) traced.sums[item * scramblings + threadIdx.x] = parts.sums[threadIdx.x];
    __syncthreads();
    for (int frame = 0; windows && frame < frame_count; ++frame) {
      window[frame].flush(spline, parts.rows_seen, launch.images, frame, launch.sign);
    }
  }
  __syncthreads();
  if (threadIdx.x < frame_count * ray_status_count && counts[threadIdx.x] > 0) {
    atomicAdd(traced.ends + threadIdx.x, static_cast<unsigned long long>(counts[threadIdx.x]));
  }
}

}  // namespace

int widest_window_px(SourcesLaunch const& launch, DeviceMedium const& medium) {
  std::size_t const there = std::visit(
      [](auto const& held) { return most_shared_bytes(trace_sources_kernel<std::remove_cvref_t<decltype(held)>>); },
      medium);
  if (!launch.spline.share || there < most_block_bytes) return 0;
  SourcesLaunch probe = launch;
  for (probe.most_window_px = most_window_nodes / launch.spline.per_px; probe.most_window_px > 0;
       --probe.most_window_px) {
    if (SharedParts::bytes(probe, threads) <= most_block_bytes) break;
  }
  return probe.most_window_px;
}

void trace_sources(SourcesLaunch const& launch, DeviceMedium const& medium, SourceOnDevice const* sources,
                   std::uint64_t count, SourcesTraced const& traced) {
  std::visit(
      [&](auto const& held) {
        auto* const kernel = trace_sources_kernel<std::remove_cvref_t<decltype(held)>>;
        std::size_t const shared = SharedParts::bytes(launch, threads);
        allow_shared_bytes(kernel, shared);
        kernel<<<blocks_for(kernel, threads, shared, count * launch.shares()), threads, shared>>>(launch, held, sources,
                                                                                                  count, traced);
        check_launch("trace_sources");
      },
      medium);
}

}  // namespace gladstone::cuda::inline rays
