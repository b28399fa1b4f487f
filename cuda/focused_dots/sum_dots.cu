#include "cuda/device/block_sum.cuh"
#include "cuda/device/device_array.h"
#include "cuda/device/launch.h"
#include "cuda/focused_dots/cone_light.cuh"

namespace gladstone::cuda {
namespace {

/// What a dot's rays come to by themselves.
struct DotRays {
  DotSums sums;
  DotErrors errors;
  bool moved;  ///< whether the flow did anything to one of them
};

template <class T>
__global__ void __launch_bounds__(dot_threads, 3)
    sum_rays_kernel(LightModel const __grid_constant__ model, SourcesView<double> const sources, Batch const batch,
                    RayRecord<T> const* const records, DotRays* const out) {
  __shared__ __align__(16) unsigned char storage[dot_threads * sizeof(DotSums)];
  static_assert(dot_threads % most_scramblings == 0, "a thread's rays are of one scrambling");
  auto* const of_scramblings = reinterpret_cast<DotSums*>(storage);
  for (std::uint64_t i = blockIdx.x; i < batch.dots; i += gridDim.x) {
    Vec2d const centre = sources.centre[batch.first + i];
    RayRecord<T> const* const rays = records + i * batch.rays;
    DotSums sum;
    bool moved = false;
    bool const tabled = model.tabled(centre);
    for (std::uint64_t j = threadIdx.x; j < batch.rays; j += dot_threads) {
      RayRecord<double> const ray = widened(rays[j]);
      sum.hits[0].add(ray.reference, ray.reference_weight, ray.reference_counts);
      sum.hits[1].add(ray.flow, ray.flow_weight, ray.flow_counts);
      moved |= ray.moved;
      if (tabled) sum.check.add(model.table, centre + model.offset(ray.place), flow_displacement(model, ray), ray);
    }
    moved = __syncthreads_or(moved);
    block_sums(sum, of_scramblings, static_cast<unsigned int>(model.scramblings));
    if (threadIdx.x == 0) {
      DotSums all;
      for (int scrambling = 0; scrambling < model.scramblings; ++scrambling) all += of_scramblings[scrambling];
      out[i] = {all, dot_errors(of_scramblings, model.scramblings, all), moved};
    }
    __syncthreads();
  }
}

__global__ void __launch_bounds__(dot_threads, 5)
    sum_dots_kernel(LightModel const __grid_constant__ model, SourcesView<double> const sources, Batch const batch,
                    DotRays const* const all_rays, DotTruth* const truth, DotCone* const cones) {
  __shared__ __align__(16) unsigned char state_storage[sizeof(ConeState)];
  __shared__ __align__(16) unsigned char cone_storage[sizeof(CorrectedCone)];
  ConeState& state = *reinterpret_cast<ConeState*>(state_storage);
  CorrectedCone& cone = *reinterpret_cast<CorrectedCone*>(cone_storage);
  for (std::uint64_t i = blockIdx.x; i < batch.dots; i += gridDim.x) {
    std::uint64_t const index = batch.first + i;
    Vec2d const centre = sources.centre[index];
    DotRays const& rays = all_rays[i];
    DotPlan const plan = DotPlan::make(model, centre, sources.radiance ? sources.radiance[index] : 1.0);
    CentroidSum<double> hits[frame_count] = {rays.sums.hits[0], rays.sums.hits[1]};
    bool const moved = rays.moved;
    bool tabled = model.tabled(centre) && moved && model.correctable(rays.sums.check, plan.expected_weight);
    if (tabled) {
      if (threadIdx.x == 0) cone = model.corrected(centre, rays.sums.check);
      __syncthreads();
      tabled = integrate_cone(model, cone, state) && !model.rays_are_better(rays.errors, rays.sums.check, state.simple);
      if (tabled) sum_cone(model, plan, cone.origin(), state.moments, state.without_medium, hits);
    }
    if (threadIdx.x == 0) {
      truth[i] = {plan.origin,
                  {hits[0], hits[1]},
                  model.error(rays.errors, tabled, tabled && state.simple),
                  tabled ? TruthPath::table : TruthPath::rays};
    }
    if (cones) {
      DotKind const kind = model.kind(moved, tabled, tabled && state.narrow);
      if (threadIdx.x == 0) {
        cones[i].kind = kind;
        if (kind == DotKind::narrow || kind == DotKind::wide) {
          cones[i].origin = cone.origin();
          cones[i].check = rays.sums.check;
        }
      }
      if (kind == DotKind::narrow) {
        constexpr int terms = PlaceRule::terms;
        for (int k = threadIdx.x; k < DisplacementMoments::count * terms; k += dot_threads) {
          cones[i].field.coefficient[k / terms][k % terms] =
              MomentField::fitted(model.places, state.moments, k / terms, k % terms);
        }
      }
    }
    __syncthreads();
  }
}

}  // namespace

template <class T>
void sum_dots(LightModel const& model, SourcesView<double> const& sources, Batch const& batch,
              RayRecord<T> const* records, DotTruth* truth, DotCone* cones) {
  DeviceArray<DotRays> rays(batch.dots, "the sums over a batch's rays");
  auto* const sum_rays = sum_rays_kernel<T>;
  sum_rays<<<blocks_for(sum_rays, dot_threads, 0, batch.dots), dot_threads>>>(model, sources, batch, records,
                                                                              rays.data());
  check_launch("sum_rays");
  sum_dots_kernel<<<blocks_for(sum_dots_kernel, dot_threads, 0, batch.dots), dot_threads>>>(model, sources, batch,
                                                                                            rays.data(), truth, cones);
  check_launch("sum_dots");
}

template void sum_dots(LightModel const&, SourcesView<double> const&, Batch const&, RayRecord<double> const*, DotTruth*,
                       DotCone*);
template void sum_dots(LightModel const&, SourcesView<double> const&, Batch const&, RayRecord<float> const*, DotTruth*,
                       DotCone*);

}  // namespace gladstone::cuda
