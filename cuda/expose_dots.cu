#include <algorithm>

#include "cuda/block_sum.cuh"
#include "cuda/expose_dots.h"
#include "cuda/launch.h"
#include "render/sensor/exposure.h"

namespace gladstone::cuda {
namespace {

constexpr int threads = 128;
constexpr int warp_size = 32;
constexpr int warps = threads / warp_size;
constexpr int tile_rays = threads;  // whose factors are summed together
constexpr int sums_per_thread = (FlowFit::most_sums + threads - 1) / threads;
constexpr unsigned int whole_warp = 0xffffffffu;

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

__device__ void add_light(DeviceImages const& images, Frame frame, int column, int row, double light) {
  if (column < 0 || row < 0 || column >= images.columns || row >= images.rows) return;
  auto const share = static_cast<unsigned long long>(to_fixed_point(light * images.light_per_weight));
  atomicAdd(images.light[static_cast<int>(frame)] + static_cast<std::size_t>(row) * images.columns + column, share);
}

/// A square piece of a frame in which a block gathers a dot's light, one copy a warp.
struct Patch {
  double* light;  ///< [warp][side][side]
  int side;
  int left, top;  ///< image position of its corner

  __device__ double* of_warp(int warp) const { return light + static_cast<std::size_t>(warp) * side * side; }

  __device__ void begin(Vec2d middle) {
    bool const sound = fabs(middle.x) < 1e8 && fabs(middle.y) < 1e8;
    left = sound ? static_cast<int>(floor(middle.x + 0.5)) - side / 2 : 0;
    top = sound ? static_cast<int>(floor(middle.y + 0.5)) - side / 2 : 0;
    for (int i = threadIdx.x; i < warps * side * side; i += threads) light[i] = 0;
    __syncthreads();
  }

  /// Sends what all warps have gathered to the image.
  __device__ void flush(DeviceImages const& images, Frame frame) const {
    __syncthreads();
    for (int i = threadIdx.x; i < side * side; i += threads) {
      double sum = 0;
      for (int warp = 0; warp < warps; ++warp) sum += of_warp(warp)[i];
      if (sum != 0) add_light(images, frame, left + i % side, top + i / side, sum);
    }
    __syncthreads();
  }
};

/// Room for the column and row shares of a group of deposits, one a warp.
struct SharesOfGroup {
  static constexpr int room = 512;
  double of[room];
};

/// Lays down `count` deposits: source(i) gives the i-th. A warp takes a group of them, works each out on a lane, its
/// shares of columns and rows included, and then spreads one after the other, a lane a pixel.
template <class Source>
__device__ void lay_down(SpotView const& spot, Patch const& patch, DeviceImages const& images, Frame frame,
                         SharesOfGroup* shares_of_warps, std::uint64_t count, Source const& source) {
  int const lane = threadIdx.x % warp_size, warp = threadIdx.x / warp_size;
  int const width = 2 * spot.half_width() + 1;
  bool const gaussian = spot.model != SpotModel::none && spot.model != SpotModel::airy;
  int const group = gaussian ? min(warp_size, SharesOfGroup::room / (2 * width)) : warp_size;
  double* const shares = shares_of_warps[warp].of;
  double* const gathered = patch.of_warp(warp);
  int const first_row = lane / 8, first_column = lane % 8;
  for (std::uint64_t base = std::uint64_t(group) * warp; base < count; base += group * warps) {
    Deposit mine;
    if (lane < group && base + lane < count) mine = source(base + lane);
    if (!(fabs(mine.at.x) < 1e8 && fabs(mine.at.y) < 1e8)) mine = {};
    unsigned int const lit = __ballot_sync(whole_warp, mine.weight != 0);
    if (lit == 0) continue;
    int const my_column = static_cast<int>(floor(mine.at.x + 0.5)) - width / 2;
    int const my_row = static_cast<int>(floor(mine.at.y + 0.5)) - width / 2;
    if (gaussian && mine.weight != 0) {
      double* const of_columns = shares + lane * 2 * width;
      spot.gaussian.shares(mine.at.x, my_column, width, of_columns);
      spot.gaussian.shares(mine.at.y, my_row, width, of_columns + width);
      for (int i = 0; i < width; ++i) of_columns[i] *= mine.weight;
    }
    __syncwarp();
    for (int which = 0; which < group; ++which) {
      if ((lit >> which & 1u) == 0) continue;
      int const c0 = __shfl_sync(whole_warp, my_column, which), r0 = __shfl_sync(whole_warp, my_row, which);
      double const* const of_columns = shares + which * 2 * width;
      double const* const of_rows = of_columns + width;
      bool const inside = c0 >= patch.left && r0 >= patch.top && c0 + width <= patch.left + patch.side &&
                          r0 + width <= patch.top + patch.side;
      double* const corner = gathered + (r0 - patch.top) * patch.side + c0 - patch.left;
      if (gaussian && inside) {
        for (int r = first_row; r < width; r += 4) {
          for (int c = first_column; c < width; c += 8) corner[r * patch.side + c] += of_rows[r] * of_columns[c];
        }
      } else {
        Deposit const light{{__shfl_sync(whole_warp, mine.at.x, which), __shfl_sync(whole_warp, mine.at.y, which)},
                            __shfl_sync(whole_warp, mine.weight, which)};
        for (int r = first_row; r < width; r += 4) {
          for (int c = first_column; c < width; c += 8) {
            double share = light.weight;
            if (gaussian) share = of_rows[r] * of_columns[c];
            if (spot.model == SpotModel::airy) {
              share *= spot.airy.share(light.at.x - (c0 + width / 2), light.at.y - (r0 + width / 2), r, c);
            }
            if (inside) {
              corner[r * patch.side + c] += share;
            } else {
              add_light(images, frame, c0 + c, r0 + r, share);
            }
          }
        }
      }
      __syncwarp();
    }
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
  return std::max(sizeof(double) * tile_rays * (FlowFit::most_factors + 1), sizeof(double) * warps * side * side);
}

template <class T>
__global__ void __launch_bounds__(threads, 4)
    expose_dots_kernel(LightModel const model, SourcesView<double> const sources, Batch const batch,
                       RayRecord<T> const* const records, DeviceImages const images, int const side,
                       DotSums* const sums) {
  extern __shared__ double dynamic[];
  __shared__ __align__(16) unsigned char state_storage[sizeof(BlockState)];
  BlockState& state = *reinterpret_cast<BlockState*>(state_storage);
  __shared__ SharesOfGroup shares[warps];
  __shared__ __align__(16) unsigned char reduction[threads * sizeof(CentroidSum<double>)];
  bool const with_images = images.light[0] != nullptr;
  for (std::uint64_t i = blockIdx.x; i < batch.dots; i += gridDim.x) {
    std::uint64_t const index = batch.first + i;
    RayRecord<T> const* const rays = records + i * batch.rays;
    DotPlan const plan = DotPlan::make(model, sources.centre[index], sources.radiance ? sources.radiance[index] : 1.0);
    CentroidSum<double> hits[frame_count];
    bool moved = false;
    for (std::uint64_t j = threadIdx.x; j < batch.rays; j += threads) {
      RayRecord<double> const ray = widened(rays[j]);
      hits[0].add(ray.reference, ray.reference_weight, ray.reference_counts);
      hits[1].add(ray.flow, ray.flow_weight, ray.flow_counts);
      moved |= ray.moved();
    }
    for (int frame = 0; frame < frame_count; ++frame) {
      hits[frame] = block_sum(hits[frame], reinterpret_cast<CentroidSum<double>*>(reduction));
    }
    if (threadIdx.x == 0) sums[i] = {plan.origin, {hits[0], hits[1]}};
    if (!with_images) continue;

    Patch patch{dynamic, side, 0, 0};
    auto const expose = [&](Frame frame, std::uint64_t count, auto const& source) {
      lay_down(model.spot, patch, images, frame, shares, count, source);
    };
    if (model.controlled && !__syncthreads_or(moved)) {
      for (Frame const frame : {Frame::reference, Frame::flow}) {
        patch.begin(plan.origin);
        expose(frame, model.source.count,
               [&](std::uint64_t k) { return reference_light(model, plan, static_cast<int>(k)); });
        patch.flush(images, frame);
      }
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
