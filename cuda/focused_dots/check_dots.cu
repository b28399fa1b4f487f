#include "cuda/device/launch.h"
#include "cuda/focused_dots/dot_cones.h"
#include "cuda/focused_dots/dot_groups.cuh"

namespace gladstone::cuda::inline focused_dots {
namespace {

constexpr int threads = dot_threads, warps = dot_warps;

/// Warp that traces the rays of one dot, one ray per lane and step.
struct CheckingWarp : Warp {
  static constexpr int abreast = 1;
  int scramblings;
  TableCheck* shared;  ///< sums over the rays, one per scrambling
  unsigned int (*statuses)[ray_status_count];
  TableCheck sums{};  ///< sums of this lane, whose rays all belong to one scrambling

  __device__ CheckingWarp(int of, TableCheck* room, unsigned int (*counts)[ray_status_count])
      : Warp{0, 1}, scramblings(of), shared(room), statuses(counts) {}
  __device__ void clear() { sums = {}; }
  __device__ TableCheck& check(int) { return sums; }
  /// Sums over the lanes of each scrambling (lanes whose numbers are equal modulo the number of scramblings), in a
  /// fixed order.
  __device__ TableCheck const* of_scramblings() const {
    TableCheck sum = sums;
    sum.each_number([groups = scramblings](double& number, int) {
      for (int step = warp_size / 2; step >= groups; step /= 2) number += __shfl_xor_sync(whole_warp, number, step);
    });
    if (lane() < scramblings) shared[lane()] = sum;
    __syncwarp();
    return shared;
  }
  __device__ void count(int frame, RayStatus status) const {
    atomicAdd(&statuses[frame][static_cast<int>(status)], 1u);
  }
};

/// Traces one dot per warp.
template <class Medium>
__global__ void __launch_bounds__(threads, 3)
    check_dots_kernel(DotModel const __grid_constant__ model, Medium const __grid_constant__ medium,
                      SourcesView<double> const dots, std::uint64_t const count, DotCone* const cones,
                      DotFound* const found, RayTally* const tally) {
  __shared__ unsigned int statuses[frame_count][ray_status_count];
  __shared__ __align__(16) unsigned char storage[warps * most_scramblings * sizeof(TableCheck)];
  int const warp = threadIdx.x / warp_size;
  CheckingWarp lanes(model.scramblings(), reinterpret_cast<TableCheck*>(storage) + warp * most_scramblings, statuses);
  for (int i = threadIdx.x; i < frame_count * ray_status_count; i += threads) (&statuses[0][0])[i] = 0;
  __syncthreads();
  double farthest = 0;
  for (std::uint64_t dot = blockIdx.x * warps + warp; dot < count; dot += gridDim.x * warps) {
    farthest = fmax(farthest, check_dot(lanes, model, medium, dots.centre[dot], cones[dot], found[dot]).farthest);
    if (lanes.lane() == 0) {
      cones[dot].light = model.reference_light(dots.centre[dot], dots.radiance ? dots.radiance[dot] : 1.0);
    }
  }
  if (lanes.lane() == 0) {
    atomicMax(&tally->largest_aim_distance, static_cast<unsigned long long>(__double_as_longlong(farthest)));
  }
  __syncthreads();
  for (int i = threadIdx.x; i < frame_count * ray_status_count; i += threads) {
    unsigned int const here = (&statuses[0][0])[i];
    if (here > 0) atomicAdd(&tally->statuses[0][0] + i, static_cast<unsigned long long>(here));
  }
}

}  // namespace

void check_dots(DotModel const& model, DeviceMedium const& medium, SourcesView<double> const& dots, std::uint64_t count,
                DotCone* cones, DotFound* found, RayTally* tally) {
  std::visit(
      [&](auto const& held) {
        auto* const kernel = check_dots_kernel<std::remove_cvref_t<decltype(held)>>;
        kernel<<<blocks_for(kernel, threads, 0, (count + warps - 1) / warps), threads>>>(model, held, dots, count,
                                                                                         cones, found, tally);
        check_launch("check_dots");
      },
      medium);
}

}  // namespace gladstone::cuda::inline focused_dots
