#pragma once

#include "cuda/focused_dots/dot_cones.h"
#include "cuda/focused_dots/dot_patch.cuh"

/// A dot's truth and light from the integral over its cone, by a whole block: what DotIntegrator does on the CPU.
namespace gladstone::cuda {

/// What the block's threads have in common while they work on a cone.
struct ConeState {
  DisplacementMoments moments[PlaceRule::most_places];
  double without_medium[PlaceRule::most_places];
  double rims[PlaceRule::most_places][ConeRule::most_directions];
  Extent extents[PlaceRule::most_places], extent;  ///< of displacements from places, and of all
  bool simple, sound, narrow;                      ///< the stop's edge; the moments; their spread
};

inline __device__ CorrectedCone cone_of(DotModel const& model, DotCone const& dot) {
  DeflectionTable const nothing;
  return {dot.kind == DotKind::still ? nothing : model.table,
          model.stop_radius,
          model.distance(),
          dot.centre,
          dot.aim,
          dot.check};
}

/// Sum over a warp's lanes, in one order; every lane gets it.
__device__ inline double warp_sum(double value) {
  for (int step = warp_size / 2; step > 0; step /= 2) value += __shfl_xor_sync(whole_warp, value, step);
  return value;
}

/// A warp looks for the stop's edge as seen from a place. @return whether it is a simple one
__device__ inline bool find_rims(CorrectedCone const& cone, ConeRule const& rule, Vec2d offset, double* rims) {
  bool sound = true;
  for (int k = threadIdx.x % warp_size; k < rule.direction_count; k += warp_size) {
    rims[k] = cone.rim(offset, rule.directions[k]);
    sound = sound && !isnan(rims[k]);
  }
  sound = __all_sync(whole_warp, sound);
  __syncwarp();
  return sound;
}

/// Moments of the whole cone at every place, and what they say of its light.
/// @param kept [place][point] where its points are kept, or null
__device__ inline void integrate_cone(DotModel const& model, CorrectedCone const& cone, ConeState& state,
                                      ConeLight* kept = nullptr) {
  int const lane = threadIdx.x % warp_size, warp = threadIdx.x / warp_size;
  if (threadIdx.x == 0) state.simple = state.sound = state.narrow = true;
  __syncthreads();
  for (int place = warp; place < model.places.count; place += dot_warps) {
    if (!find_rims(cone, model.cone, model.offset(model.places.places[place]), state.rims[place])) state.simple = false;
  }
  __syncthreads();
  int const count = model.cone.points_of(state.simple);
  for (int place = warp; place < model.places.count; place += dot_warps) {
    Vec2d const offset = model.offset(model.places.places[place]);
    DisplacementMoments moments;
    double without_medium = 0;
    Extent extent;
    for (int k = lane; k < count; k += warp_size) {
      ConeLight const light = cone_light(cone, model.cone, k, offset, state.simple ? state.rims[place] : nullptr);
      if (kept) kept[place * count + k] = light;
      moments.add(light.weight, light.displacement);
      if (light.weight != 0) extent.include(light.displacement);
      without_medium += light.without_medium;
    }
    without_medium = warp_sum(without_medium);
    for (int i = 0; i < DisplacementMoments::count; ++i) {
      double const sum = warp_sum(moments.of[i]);
      if (lane == 0) state.moments[place].of[i] = sum;
    }
    for (int step = warp_size / 2; step > 0; step /= 2) {
      extent.include(
          {__shfl_xor_sync(whole_warp, extent.low.x, step), __shfl_xor_sync(whole_warp, extent.low.y, step)});
      extent.include(
          {__shfl_xor_sync(whole_warp, extent.high.x, step), __shfl_xor_sync(whole_warp, extent.high.y, step)});
    }
    if (lane == 0) {
      state.without_medium[place] = without_medium;
      state.extents[place] = extent;
      cone.finish(state.moments[place], without_medium);
      if (!isfinite(state.moments[place].square())) state.sound = false;
      if (!model.narrow(state.moments[place])) state.narrow = false;
    }
  }
  __syncthreads();
  if (threadIdx.x == 0) {
    state.extent = state.extents[0];
    for (int place = 1; place < model.places.count; ++place) {
      state.extent.include(state.extents[place].low);
      state.extent.include(state.extents[place].high);
    }
  }
  __syncthreads();
}

/// Lays down the source's disc with the spots that the moments make of it. A warp takes some points of the source at a
/// time: first its lanes work out all their pixels' edges, then the spots' factors, then a lane a pixel.
/// @param origin image of its centre where the moments count from [px] @param scratch of the warps
__device__ inline void lay_down_narrow(DotModel const& model, Vec2d origin, double light, MomentField const& field,
                                       Patch const& patch, DeviceImages const& images, SharesOfGroup* scratch) {
  CubatureView const& source = model.source;
  using M = DisplacementMoments;
  using Spot = GaussianSpot<double>;
  constexpr int orders = M::order + 1, most_group = 4;
  int const lane = threadIdx.x % warp_size, warp = threadIdx.x / warp_size;
  Spot const spot = model.spot;
  double const per_sigma = 1 / spot.sigma;
  int const width = 2 * spot.half_width() + 1, edges = width + 1;
  int const room_of_point = 2 * orders * edges + M::count;
  int const group = min(most_group, SharesOfGroup::room / room_of_point);
  double* const gathered = patch.of_warp(warp);
  auto const place = [&](int point) {
    Deposit here = reference_light(model, origin, light, point);
    if (!(fabs(here.at.x) < 1e8 && fabs(here.at.y) < 1e8)) here = {};
    return here;
  };
  for (int first = warp * group; first < source.count; first += dot_warps * group) {
    int const here = min(group, source.count - first);
    // factors of a point: [axis][order][edge], then its moments
    auto const factors = [&](int which) { return scratch[warp].of + which * room_of_point; };
    for (int row = lane / 8; row < 2 * here; row += warp_size / 8) {
      int const which = row / 2, axis = row % 2;
      Deposit const here_light = place(first + which);
      Footprint const reach = spot.footprint(here_light.at);
      double const from = axis == 0 ? reach.column - here_light.at.x : reach.row - here_light.at.y;
      double* const out = factors(which) + axis * orders * edges;
      for (int edge = lane % 8; edge < edges; edge += 8) {
        double const t = (from + edge - 0.5) * per_sigma;
        Spot::EdgeTerms const terms(t, per_sigma);
        out[edge] = Spot::edge_value(t);
        for (int k = 1; k < orders; ++k) out[k * edges + edge] = terms.of[k];
      }
    }
    for (int which = lane / 16; which < here; which += warp_size / 16) {
      int const moment = lane % 16;
      if (moment >= M::count) continue;
      factors(which)[2 * orders * edges + moment] = field.value(moment, source.points[first + which]);
    }
    __syncwarp();
    // from edges to pixels
    for (int task = lane; task < here * 2 * orders; task += warp_size) {
      double* const row = factors(task / (2 * orders)) + task % (2 * orders) * edges;
      double before = row[0];
      for (int i = 0; i < width; ++i) {
        double const next = row[i + 1];
        row[i] = next - before;
        before = next;
      }
    }
    __syncwarp();
    // from the orders along y to what stands with an order along x
    for (int task = lane; task < 8 * here; task += warp_size) {
      int const which = task / 8;
      double const* const moments = factors(which) + 2 * orders * edges;
      double const weight = place(first + which).weight * images.units_per_weight;
      for (int i = task % 8; i < width; i += 8) {
        double* const along_y = factors(which) + orders * edges + i;
        double share[orders], with[orders] = {};
        for (int b = 0; b < orders; ++b) share[b] = weight * along_y[b * edges];
#pragma unroll
        for (int a = 0; a < orders; ++a) {
#pragma unroll
          for (int b = 0; a + b < orders; ++b) with[a] += moments[M::at(a, b)] * share[b];
        }
#pragma unroll
        for (int a = 0; a < orders; ++a) along_y[a * edges] = with[a];
      }
    }
    __syncwarp();
    for (int which = 0; which < here; ++which) {
      Footprint const reach = spot.footprint(place(first + which).at);
      bool const inside = reach.column >= patch.left && reach.row >= patch.top &&
                          reach.column + width <= patch.left + patch.side &&
                          reach.row + width <= patch.top + patch.side;
      double* const corner = gathered + (reach.row - patch.top) * patch.side + reach.column - patch.left;
      for (int row = lane / 8; row < width; row += warp_size / 8) {
        double const* const y = factors(which) + orders * edges + row;
        for (int column = lane % 8; column < width; column += 8) {
          double const* const x = factors(which) + column;
          double share = 0;
#pragma unroll
          for (int a = 0; a < orders; ++a) share += x[a * edges] * y[a * edges];
          share = whole_units(share);
          if (inside) {
            corner[row * patch.side + column] += share;
          } else {
            add_light(images, Frame::flow, reach.column + column, reach.row + row, share);
          }
        }
      }
      __syncwarp();
    }
  }
}

}  // namespace gladstone::cuda
