#include <algorithm>

#include "cuda/device/block_sum.cuh"
#include "cuda/device/launch.h"
#include "cuda/focused_dots/box_light.cuh"
#include "cuda/focused_dots/expose_dots.h"

namespace gladstone::cuda {
namespace {

constexpr int threads = dot_threads;
constexpr std::uint64_t most_blocks = 1024;  // each of which keeps the points of a cone
constexpr int tile_rays = threads;           // whose factors are summed together
constexpr int sums_per_thread = (FlowFit::most_sums + threads - 1) / threads;

/// What the block's threads have in common.
struct BlockState {
  FlowFit fit;
  double sums[FlowFit::most_sums];
};

/// FlowFit over a dot's rays by a whole block. @param tile tile_rays rows of factors and weight
template <class T>
__device__ void fit_flow(LightModel const& model, RayRecord<T> const* rays, std::uint64_t count, BlockState& state,
                         double (*tile)[FlowFit::most_factors + 1], void* reduction) {
  FlowFit& fit = state.fit;
  if (threadIdx.x == 0) {
    fit = FlowFit();
    fit.prepare(count, model.image.stop_radius, model.image.source_half > 0);
  }
  __syncthreads();
  int const factors = fit.factor_count(), sum_count = fit.sum_count(), terms = factors - FlowFit::targets;
  int first[sums_per_thread] = {}, second[sums_per_thread] = {};
  double sum[sums_per_thread] = {};
  for (int s = 0; s < sums_per_thread; ++s) {
    int const index = threadIdx.x + s * threads;
    if (index < sum_count) fit.factors_of_sum(index, first[s], second[s]);
  }
  for (std::uint64_t base = 0; base < count; base += tile_rays) {
    double* const mine = tile[threadIdx.x];
    mine[FlowFit::most_factors] = 0;
    if (base + threadIdx.x < count) {
      RayRecord<double> const ray = widened(rays[base + threadIdx.x]);
      if (ray.flow_weight > 0) {
        fit.factors(ray, flow_displacement(model, ray), mine);
        mine[FlowFit::most_factors] = ray.flow_weight;
      }
    }
    __syncthreads();
    int const here = static_cast<int>(min(std::uint64_t{tile_rays}, count - base));
    for (int ray = 0; ray < here; ++ray) {
      double const* const factor = tile[ray];
      double const weight = factor[FlowFit::most_factors];
      if (weight == 0) continue;
      for (int s = 0; s < sums_per_thread; ++s) sum[s] += weight * factor[first[s]] * factor[second[s]];
    }
    __syncthreads();
  }
  for (int s = 0; s < sums_per_thread; ++s) {
    int const index = threadIdx.x + s * threads;
    if (index < sum_count) state.sums[index] = sum[s];
  }
  __syncthreads();
  if (!(state.sums[0] > 0)) return;
  int const first_target = terms * (terms + 1) / 2;
  Vec2d const mean = Vec2d{state.sums[first_target], state.sums[first_target + terms]} / state.sums[0];
  __syncthreads();
  if (threadIdx.x < warp_size) fit.solve(state.sums, threadIdx.x, warp_size, [] { __syncwarp(); });
  __syncthreads();
  FlowScatter scatter;
  for (std::uint64_t i = threadIdx.x; i < count; i += threads) {
    RayRecord<double> const ray = widened(rays[i]);
    if (ray.flow_weight > 0) scatter += fit.scatter(ray, flow_displacement(model, ray), mean);
  }
  scatter = block_sum(scatter, static_cast<FlowScatter*>(reduction));
  if (threadIdx.x == 0) fit.settle(mean, scatter);
  __syncthreads();
}

/// Dynamic shared memory: the tile of factors, then the patch, in the same place.
std::size_t shared_bytes(int side) {
  return std::max(sizeof(double) * tile_rays * (FlowFit::most_factors + 1), patch_bytes(side));
}

/// Points that a wide cone is integrated over, at most.
std::size_t points_of_a_cone(LightModel const& model) {
  if (!model.moment_images.exist()) return 0;
  return static_cast<std::size_t>(model.places.count) *
         static_cast<std::size_t>(std::max(model.cone.count, model.cone.scattered_count));
}

/// Room for one cone's points a block, since a block works on one dot at a time.
struct RoomForCones {
  DeviceArray<ConeLight> light;
  DeviceArray<unsigned short> order;

  /// @param blocks fewer on return where the device has little left, which only costs time
  static RoomForCones make(std::size_t points, int& blocks) {
    for (;; blocks = (blocks + 1) / 2) try {
        std::size_t const all = static_cast<std::size_t>(blocks) * points;
        return {DeviceArray<ConeLight>(all, "the points of wide cones"),
                DeviceArray<unsigned short>(all, "the points of wide cones")};
      } catch (OutOfDeviceMemory const&) {
        if (blocks == 1) throw;
      }
  }
};

template <class T>
__global__ void __launch_bounds__(threads, 4)
    expose_dots_kernel(LightModel const __grid_constant__ model, SourcesView<double> const sources, Batch const batch,
                       RayRecord<T> const* const records, DotTruth const* const truth, DotCone const* const cones,
                       DeviceImages const images, int const side, ConeLight* const room, unsigned short* const order,
                       std::size_t const points_a_block) {
  extern __shared__ double dynamic[];
  __shared__ __align__(16) unsigned char state_storage[std::max(sizeof(BlockState), sizeof(ConeState))];
  __shared__ __align__(16) unsigned char cone_storage[sizeof(CorrectedCone)];
  __shared__ __align__(16) unsigned char scratch[std::max(sizeof(BoxState), dot_warps * sizeof(SharesOfGroup))];
  SharesOfGroup* const shares = reinterpret_cast<SharesOfGroup*>(scratch);
  BlockState& state = *reinterpret_cast<BlockState*>(state_storage);
  ConeState& cone_state = *reinterpret_cast<ConeState*>(state_storage);
  CorrectedCone& cone = *reinterpret_cast<CorrectedCone*>(cone_storage);
  for (std::uint64_t i = blockIdx.x; i < batch.dots; i += gridDim.x) {
    DotKind const kind = cones[i].kind;
    if (kind != DotKind::wide && kind != DotKind::rays) continue;
    std::uint64_t const index = batch.first + i;
    RayRecord<T> const* const rays = records + i * batch.rays;
    DotPlan const plan = DotPlan::make(model, sources.centre[index], sources.radiance ? sources.radiance[index] : 1.0);
    Patch patch{dynamic, side, 0, 0};
    auto const expose = [&](Frame frame, std::uint64_t count, auto const& source) {
      lay_down(model.spot, patch, images, frame, shares, count, source);
    };
    __syncthreads();
    if (model.controlled) lay_down_reference(model, plan, patch, images, Frame::reference, shares);
    if (kind == DotKind::wide) {
      if (threadIdx.x == 0) cone = model.corrected(sources.centre[index], cones[i].check);
      __syncthreads();
      ConeLight* const kept = room + blockIdx.x * points_a_block;
      bool const sound = integrate_cone(model, cone, cone_state, kept);
      ConePoints const points{kept, order + blockIdx.x * points_a_block, model.cone_points(cone_state.simple)};
      if (sound &&
          expose_wide(model, plan, cone, cone_state, points, *reinterpret_cast<BoxState*>(scratch), patch, images)) {
        continue;
      }
      __syncthreads();
    }
    if (model.controlled) {
      fit_flow(model, rays, batch.rays, state, reinterpret_cast<double(*)[FlowFit::most_factors + 1]>(dynamic),
               dynamic);
      FlowFit const& fit = state.fit;
      CubatureView const& pupil = model.pupil[pupil_rule(fit.pupil_spread())];
      patch.begin(plan.origin + fit.displacement({}, {}));
      expose(Frame::flow, std::uint64_t(model.source.count) * pupil.count, [&](std::uint64_t k) {
        return expected_light(model, plan, fit, pupil, static_cast<int>(k / pupil.count),
                              static_cast<int>(k % pupil.count));
      });
      expose(Frame::flow, batch.rays,
             [&](std::uint64_t k) { return remaining_light(model, plan, fit, widened(rays[k])).landed; });
      expose(Frame::flow, batch.rays,
             [&](std::uint64_t k) { return remaining_light(model, plan, fit, widened(rays[k])).expected; });
      patch.flush(images, Frame::flow);
    } else {
      for (Frame const frame : {Frame::reference, Frame::flow}) {
        CentroidSum<double> const seen = truth[i].hits[static_cast<int>(frame)];
        patch.begin(seen.weight > 0 ? plan.origin + seen.first / seen.weight : plan.origin);
        expose(frame, batch.rays, [&](std::uint64_t k) {
          RayRecord<double> const ray = widened(rays[k]);
          return frame == Frame::reference ? Deposit{plan.origin + ray.reference, ray.reference_weight}
                                           : Deposit{plan.origin + ray.flow, ray.flow_weight};
        });
        patch.flush(images, frame);
      }
    }
  }
}

}  // namespace

template <class T>
void expose_dots(LightModel const& model, SourcesView<double> const& sources, Batch const& batch,
                 RayRecord<T> const* records, DotTruth const* truth, DotCone const* cones, DeviceImages const& images) {
  auto* const kernel = expose_dots_kernel<T>;
  int const side = patch_side(model, most_shared_bytes(kernel));
  std::size_t const shared = shared_bytes(side);
  allow_shared_bytes(kernel, shared);
  std::size_t const points_a_block = points_of_a_cone(model);
  std::uint64_t const wanted = points_a_block > 0 ? std::min<std::uint64_t>(batch.dots, most_blocks) : batch.dots;
  int blocks = blocks_for(kernel, threads, shared, wanted);
  RoomForCones room = RoomForCones::make(points_a_block, blocks);
  kernel<<<blocks, threads, shared>>>(model, sources, batch, records, truth, cones, images, side, room.light.data(),
                                      room.order.data(), points_a_block);
  check_launch("expose_dots");
}

template void expose_dots(LightModel const&, SourcesView<double> const&, Batch const&, RayRecord<double> const*,
                          DotTruth const*, DotCone const*, DeviceImages const&);
template void expose_dots(LightModel const&, SourcesView<double> const&, Batch const&, RayRecord<float> const*,
                          DotTruth const*, DotCone const*, DeviceImages const&);

}  // namespace gladstone::cuda
