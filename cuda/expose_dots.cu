#include <algorithm>

#include "cuda/block_sum.cuh"
#include "cuda/cone_light.cuh"
#include "cuda/expose_dots.h"
#include "cuda/launch.h"

namespace gladstone::cuda {
namespace {

constexpr int threads = dot_threads;
constexpr int tile_rays = threads;  // whose factors are summed together
constexpr int sums_per_thread = (FlowFit::most_sums + threads - 1) / threads;

template <class T>
__device__ RayRecord<double> widened(RayRecord<T> const& ray) {
  if constexpr (std::is_same_v<T, double>) {
    return ray;
  } else {
    auto const wide = [](Vec2<T> v) { return Vec2d{v.x, v.y}; };
    return {wide(ray.place), wide(ray.pupil),      wide(ray.arrival), wide(ray.reference),  wide(ray.flow),
            ray.weight,      ray.reference_weight, ray.flow_weight,   ray.reference_counts, ray.flow_counts};
  }
}

/// What the block's threads have in common.
struct BlockState {
  FlowFit fit;
  double sums[FlowFit::most_sums];
};

struct FitScatter {
  double unexplained = 0, square = 0;
  __device__ FitScatter& operator+=(FitScatter const& o) {
    unexplained += o.unexplained;
    square += o.square;
    return *this;
  }
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
  FitScatter scatter;
  for (std::uint64_t i = threadIdx.x; i < count; i += threads) {
    RayRecord<double> const ray = widened(rays[i]);
    if (!(ray.flow_weight > 0)) continue;
    Vec2d const hit = flow_displacement(model, ray), rest = hit - fit.displacement(ray.place, ray.pupil);
    scatter.square += ray.flow_weight * dot(hit - mean, hit - mean);
    scatter.unexplained += ray.flow_weight * dot(rest, rest);
  }
  scatter = block_sum(scatter, static_cast<FitScatter*>(reduction));
  if (threadIdx.x == 0) fit.settle(mean, scatter.unexplained, scatter.square);
  __syncthreads();
}

/// Dynamic shared memory: the tile of factors, then the patch, in the same place.
std::size_t shared_bytes(int side) {
  return std::max(std::max(sizeof(TableCheck) * threads, sizeof(double) * tile_rays * (FlowFit::most_factors + 1)),
                  sizeof(double) * dot_warps * side * side);
}

template <class T>
__global__ void __launch_bounds__(threads, 4)
    expose_dots_kernel(LightModel const model, SourcesView<double> const sources, Batch const batch,
                       RayRecord<T> const* const records, DeviceImages const images, int const side,
                       DotSums* const sums) {
  extern __shared__ double dynamic[];
  __shared__ __align__(16) unsigned char state_storage[sizeof(BlockState)];
  BlockState& state = *reinterpret_cast<BlockState*>(state_storage);
  __shared__ SharesOfGroup shares[dot_warps];
  void* const reduction = dynamic;
  __shared__ __align__(16) unsigned char cone_storage[sizeof(CorrectedCone)];
  __shared__ __align__(16) unsigned char cone_state_storage[sizeof(ConeState)];
  CorrectedCone& cone = *reinterpret_cast<CorrectedCone*>(cone_storage);
  ConeState& cone_state = *reinterpret_cast<ConeState*>(cone_state_storage);
  bool const with_images = images.light[0] != nullptr;
  for (std::uint64_t i = blockIdx.x; i < batch.dots; i += gridDim.x) {
    std::uint64_t const index = batch.first + i;
    RayRecord<T> const* const rays = records + i * batch.rays;
    DotPlan const plan = DotPlan::make(model, sources.centre[index], sources.radiance ? sources.radiance[index] : 1.0);
    CentroidSum<double> hits[frame_count];
    bool moved = false, tabled = model.tabled(sources.centre[index]);
    TableCheck table_check;
    for (std::uint64_t j = threadIdx.x; j < batch.rays; j += threads) {
      RayRecord<double> const ray = widened(rays[j]);
      hits[0].add(ray.reference, ray.reference_weight, ray.reference_counts);
      hits[1].add(ray.flow, ray.flow_weight, ray.flow_counts);
      moved |= ray.moved();
      if (tabled) {
        table_check.add(model.table, sources.centre[index] + model.offset(ray.place), flow_displacement(model, ray),
                        ray);
      }
    }
    moved = __syncthreads_or(moved);
    for (int frame = 0; frame < frame_count; ++frame) {
      hits[frame] = block_sum(hits[frame], reinterpret_cast<CentroidSum<double>*>(reduction));
    }
    tabled = tabled && moved;
    if (tabled) {
      table_check = block_sum(table_check, reinterpret_cast<TableCheck*>(dynamic));
      if (threadIdx.x == 0) cone = model.corrected(sources.centre[index], table_check);
      __syncthreads();
      tabled = integrate_cone(model, cone, cone_state);
      if (tabled) sum_cone(model, plan, cone, cone_state.moments, hits);
    }
    if (threadIdx.x == 0) sums[i] = {plan.origin, {hits[0], hits[1]}};
    if (!with_images) continue;

    Patch patch{dynamic, side, 0, 0};
    auto const expose = [&](Frame frame, std::uint64_t count, auto const& source) {
      lay_down(model.spot, patch, images, frame, shares, count, source);
    };
    if (model.controlled && !moved) {
      for (Frame const frame : {Frame::reference, Frame::flow}) {
        patch.begin(plan.origin);
        expose(frame, model.source.count,
               [&](std::uint64_t k) { return reference_light(model, plan, static_cast<int>(k)); });
        patch.flush(images, frame);
      }
    } else if (tabled && expose_cone(model, plan, cone, cone_state, patch, images, shares)) {
      patch.begin(plan.origin);
      expose(Frame::reference, model.source.count,
             [&](std::uint64_t k) { return reference_light(model, plan, static_cast<int>(k)); });
      patch.flush(images, Frame::reference);
    } else if (model.controlled) {
      fit_flow(model, rays, batch.rays, state, reinterpret_cast<double(*)[FlowFit::most_factors + 1]>(dynamic),
               reduction);
      FlowFit const& fit = state.fit;
      patch.begin(plan.origin);
      expose(Frame::reference, model.source.count,
             [&](std::uint64_t k) { return reference_light(model, plan, static_cast<int>(k)); });
      patch.flush(images, Frame::reference);
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
        CentroidSum<double> const& seen = hits[static_cast<int>(frame)];
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

__global__ void to_light_kernel(unsigned long long const* fixed_point, double* light, std::size_t count) {
  std::size_t const i = blockIdx.x * std::size_t{blockDim.x} + threadIdx.x;
  if (i < count) light[i] = static_cast<double>(static_cast<long long>(fixed_point[i])) / fixed_point_one;
}

}  // namespace

template <class T>
void expose_dots(LightModel const& model, SourcesView<double> const& sources, Batch const& batch,
                 RayRecord<T> const* records, DeviceImages const& images, DotSums* sums) {
  // wide enough for the dot, its spot and some pixels of spread, what falls beside it goes to the image at once; eight
  // more than a multiple of sixteen, so that four rows of a spot lie in different banks
  int const width = 2 * model.spot.half_width() + 1;
  int const wanted = width + 2 * static_cast<int>(std::ceil(model.image.half_size_px())) + 6;
  int const side = std::min(56, 8 + (wanted + 7) / 16 * 16);
  auto* const kernel = expose_dots_kernel<T>;
  std::size_t const shared = shared_bytes(side);
  check(cudaFuncSetAttribute(kernel, cudaFuncAttributeMaxDynamicSharedMemorySize, static_cast<int>(shared)),
        "cudaFuncSetAttribute");
  kernel<<<blocks_for(kernel, threads, shared, batch.dots), threads, shared>>>(model, sources, batch, records, images,
                                                                               side, sums);
  check_launch("expose_dots");
}

template void expose_dots(LightModel const&, SourcesView<double> const&, Batch const&, RayRecord<double> const*,
                          DeviceImages const&, DotSums*);
template void expose_dots(LightModel const&, SourcesView<double> const&, Batch const&, RayRecord<float> const*,
                          DeviceImages const&, DotSums*);

void to_light(unsigned long long const* fixed_point, double* light, std::size_t count) {
  constexpr int block = 256;
  to_light_kernel<<<static_cast<unsigned int>((count + block - 1) / block), block>>>(fixed_point, light, count);
  check_launch("to_light");
}

}  // namespace gladstone::cuda
