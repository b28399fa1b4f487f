#include "cuda/block_sum.cuh"
#include "cuda/cone_light.cuh"
#include "cuda/launch.h"

namespace gladstone::cuda {
namespace {

/// What two sums have in common, so that they take one pass.
struct RaySums {
  CentroidSum<double> hits[frame_count];
  TableCheck check;
  __device__ RaySums& operator+=(RaySums const& o) {
    for (int frame = 0; frame < frame_count; ++frame) hits[frame] += o.hits[frame];
    check += o.check;
    return *this;
  }
};

template <class T>
__global__ void __launch_bounds__(dot_threads, 5)
    sum_dots_kernel(LightModel const __grid_constant__ model, SourcesView<double> const sources, Batch const batch,
                    RayRecord<T> const* const records, DotSums* const sums, DotCone* const cones) {
  __shared__ __align__(16) unsigned char storage[std::max(dot_threads * sizeof(RaySums), sizeof(ConeState))];
  __shared__ __align__(16) unsigned char cone_storage[sizeof(CorrectedCone)];
  ConeState& state = *reinterpret_cast<ConeState*>(storage);
  CorrectedCone& cone = *reinterpret_cast<CorrectedCone*>(cone_storage);
  for (std::uint64_t i = blockIdx.x; i < batch.dots; i += gridDim.x) {
    std::uint64_t const index = batch.first + i;
    Vec2d const centre = sources.centre[index];
    RayRecord<T> const* const rays = records + i * batch.rays;
    DotPlan const plan = DotPlan::make(model, centre, sources.radiance ? sources.radiance[index] : 1.0);
    RaySums sum;
    bool moved = false, tabled = model.tabled(centre);
    for (std::uint64_t j = threadIdx.x; j < batch.rays; j += dot_threads) {
      RayRecord<double> const ray = widened(rays[j]);
      sum.hits[0].add(ray.reference, ray.reference_weight, ray.reference_counts);
      sum.hits[1].add(ray.flow, ray.flow_weight, ray.flow_counts);
      moved |= ray.moved();
      if (tabled) sum.check.add(model.table, centre + model.offset(ray.place), flow_displacement(model, ray), ray);
    }
    moved = __syncthreads_or(moved);
    sum = block_sum(sum, reinterpret_cast<RaySums*>(storage));
    tabled = tabled && moved && model.correctable(sum.check, plan.expected_weight);
    if (tabled) {
      if (threadIdx.x == 0) cone = model.corrected(centre, sum.check);
      __syncthreads();
      tabled = integrate_cone(model, cone, state) && !model.rays_are_better(sum.check, state.simple);
      if (tabled) sum_cone(model, plan, cone.origin(), state.moments, state.without_medium, sum.hits);
    }
    if (threadIdx.x == 0) sums[i] = {plan.origin, {sum.hits[0], sum.hits[1]}};
    if (cones) {
      DotKind const kind = model.kind(moved, tabled, tabled && state.narrow);
      if (threadIdx.x == 0) {
        cones[i].kind = kind;
        if (kind == DotKind::narrow || kind == DotKind::wide) {
          cones[i].origin = cone.origin();
          cones[i].check = sum.check;
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
              RayRecord<T> const* records, DotSums* sums, DotCone* cones) {
  auto* const kernel = sum_dots_kernel<T>;
  kernel<<<blocks_for(kernel, dot_threads, 0, batch.dots), dot_threads>>>(model, sources, batch, records, sums, cones);
  check_launch("sum_dots");
}

template void sum_dots(LightModel const&, SourcesView<double> const&, Batch const&, RayRecord<double> const*, DotSums*,
                       DotCone*);
template void sum_dots(LightModel const&, SourcesView<double> const&, Batch const&, RayRecord<float> const*, DotSums*,
                       DotCone*);

}  // namespace gladstone::cuda
