#include "cuda/device/launch.h"
#include "cuda/focused_dots/dot_patch.cuh"

namespace gladstone::cuda {
namespace {

constexpr int threads = dot_threads, warps = dot_warps;

/// Sums a check's numbers over the lanes of a warp whose numbers agree modulo `groups`, in one order.
__device__ void sum_over_lanes(TableCheck& check, int groups) {
  check.each_number([groups](double& number, int) {
    for (int step = warp_size / 2; step >= groups; step /= 2) number += __shfl_xor_sync(whole_warp, number, step);
  });
}

/// A warp a dot: aims, traces as many rays as it takes, a lane a ray, and compares them with the table.
template <class Medium>
__global__ void __launch_bounds__(threads, 3)
    check_dots_kernel(DotModel const __grid_constant__ model, Medium const __grid_constant__ medium,
                      SourcesView<double> const dots, std::uint64_t const count, DotCone* const cones,
                      DotFound* const found_of, RayTally* const tally) {
  __shared__ unsigned int statuses[frame_count][ray_status_count];
  __shared__ __align__(16) unsigned char storage[warps * most_scramblings * sizeof(TableCheck)];
  int const lane = threadIdx.x % warp_size, warp = threadIdx.x / warp_size;
  auto* const of_scramblings = reinterpret_cast<TableCheck*>(storage) + warp * most_scramblings;
  for (int i = threadIdx.x; i < frame_count * ray_status_count; i += threads) (&statuses[0][0])[i] = 0;
  __syncthreads();
  double farthest = 0;
  for (std::uint64_t dot = blockIdx.x * warps + warp; dot < count; dot += gridDim.x * warps) {
    Vec2d const centre = dots.centre[dot];
    DotAim const aim = aim_dot(model, centre);
    farthest = fmax(farthest, aim.farthest);
    TableCheck mine, all;
    CheckErrors errors{};
    std::int64_t passing[frame_count] = {};
    int traced = 0;
    DotKind kind = aim.kind;
    for (int enough = model.fewest_rays; kind == DotKind::narrow; enough = min(2 * enough, model.most_rays)) {
      bool lost = false;
      for (int first = traced; first < enough; first += warp_size) {
        int const k = first + lane;
        bool counts[frame_count] = {};
        if (k < enough) {
          SentRay const sent = send_ray(model, centre, aim.pupil, k);
          Vec2d const from[1] = {sent.from}, pupil[1] = {sent.pupil};
          Deflection found[1];
          deflect(model.bench, medium, from, pupil, found);
          CheckedRay const checked = check_ray(model, aim.pupil, sent, found[0]);
          mine.add(checked.at, found[0], checked.expected);
          lost = lost || found[0].status != RayStatus::alive;
          for (int frame = 0; frame < frame_count; ++frame) {
            counts[frame] = reaches_sensor_plane(checked.status[frame]);
            atomicAdd(&statuses[frame][static_cast<int>(checked.status[frame])], 1u);
          }
        }
        for (int frame = 0; frame < frame_count; ++frame) {
          passing[frame] += __popc(__ballot_sync(whole_warp, counts[frame]));
        }
      }
      traced = enough;
      TableCheck sum = mine;
      sum_over_lanes(sum, model.scramblings());
      if (lane < model.scramblings()) of_scramblings[lane] = sum;
      __syncwarp();
      all = {};
      for (int i = 0; i < model.scramblings(); ++i) all += of_scramblings[i];
      errors = check_errors(of_scramblings, model.scramblings(), all);
      __syncwarp();
      if (__any_sync(whole_warp, lost)) kind = DotKind::left;
      if (model.enough(errors, traced)) break;
    }
    if (lane != 0) continue;
    DotCone& cone = cones[dot];
    cone.kind = kind;
    cone.centre = centre;
    cone.aim = aim.pupil;
    cone.light = model.light_of(centre, dots.radiance ? dots.radiance[dot] : 1.0);
    cone.check = all;
    cone.errors = errors;
    DotTruth seen{};
    seen.origin = model.to_pixel(centre);
    for (int frame = 0; frame < frame_count; ++frame) seen.hits[frame].count = passing[frame];
    found_of[dot] = {seen, traced, kind == DotKind::left};
  }
  if (lane == 0) atomicMax(&tally->farthest_aim, static_cast<unsigned long long>(__double_as_longlong(farthest)));
  __syncthreads();
  for (int i = threadIdx.x; i < frame_count * ray_status_count; i += threads) {
    unsigned int const here = (&statuses[0][0])[i];
    if (here > 0) atomicAdd(&tally->statuses[0][0] + i, static_cast<unsigned long long>(here));
  }
}

}  // namespace

void check_dots(DotModel const& model, DeviceMedium<double> const& medium, SourcesView<double> const& dots,
                std::uint64_t count, DotCone* cones, DotFound* found, RayTally* tally) {
  std::visit(
      [&](auto const& held) {
        auto* const kernel = check_dots_kernel<std::remove_cvref_t<decltype(held)>>;
        kernel<<<blocks_for(kernel, threads, 0, (count + warps - 1) / warps), threads>>>(model, held, dots, count,
                                                                                         cones, found, tally);
        check_launch("check_dots");
      },
      medium);
}

}  // namespace gladstone::cuda
