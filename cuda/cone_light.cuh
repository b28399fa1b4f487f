#pragma once

#include "cuda/dot_patch.cuh"
#include "render/scene/dot_light.h"

/// A dot's truth and light from the integral over its cone, by a whole block: what DotExposure does on the CPU.
namespace gladstone::cuda {

/// What the block's threads have in common while they work on a cone.
struct ConeState {
  DisplacementMoments moments[PlaceRule::most_places];
  double without_medium[PlaceRule::most_places];
  MomentField field;
  BoxRange boxes;
  double rims[PlaceRule::most_places][ConeRule::most_directions];
  bool simple, sound, narrow;  ///< the stop's edge; the moments; their spread
};

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

/// Calls visit(light) for the warp's points of a cone's cross-section as seen from a place.
/// @param kept where the points of all places are kept, once they are worked out; null: they are not
template <class Visit>
__device__ void visit_cone(LightModel const& model, CorrectedCone const& cone, ConeState const& state, int place,
                           ConeLight* kept, bool work_out, Visit const& visit) {
  ConeRule const& rule = model.cone;
  Vec2d const offset = model.offset(model.places.places[place]);
  double const* const rims = state.simple ? state.rims[place] : nullptr;
  int const count = rims ? rule.count : rule.scattered_count;
  if (kept) kept += static_cast<std::size_t>(place) * count;
  for (int k = threadIdx.x % warp_size; k < count; k += warp_size) {
    if (!work_out) {
      visit(kept[k]);
      continue;
    }
    ConeLight const light = rims ? cone_light(cone, rule, k, offset, rims) : smoothed_light(cone, rule, k, offset);
    if (kept) kept[k] = light;
    visit(light);
  }
  __syncwarp();
}

/// Sums a warp's moments for a place of the source into the state.
__device__ inline void keep_moments(ConeState& state, int place, DisplacementMoments const& moments) {
  for (int i = 0; i < DisplacementMoments::count; ++i) {
    double const sum = warp_sum(moments.of[i]);
    if (threadIdx.x % warp_size == 0) state.moments[place].of[i] = sum;
  }
}

/// Moments of the whole cone at every place, and what they say of its light. @return state.sound
__device__ inline bool integrate_cone(LightModel const& model, CorrectedCone const& cone, ConeState& state,
                                      ConeLight* kept = nullptr) {
  int const warp = threadIdx.x / warp_size;
  if (threadIdx.x == 0) {
    state.simple = state.sound = state.narrow = true;
  }
  __syncthreads();
  for (int place = warp; place < model.places.count; place += dot_warps) {
    if (!find_rims(cone, model.cone, model.offset(model.places.places[place]), state.rims[place])) state.simple = false;
  }
  __syncthreads();
  for (int place = warp; place < model.places.count; place += dot_warps) {
    DisplacementMoments moments;
    double without_medium = 0;
    visit_cone(model, cone, state, place, kept, true, [&](ConeLight const& light) {
      moments.add(light.weight, light.displacement);
      without_medium += light.without_medium;
    });
    without_medium = warp_sum(without_medium);
    keep_moments(state, place, moments);
    if (threadIdx.x % warp_size == 0) {
      state.without_medium[place] = without_medium;
      cone.finish(state.moments[place], without_medium);
      if (!isfinite(state.moments[place].square())) state.sound = false;
      if (!model.narrow(state.moments[place])) state.narrow = false;
    }
  }
  __syncthreads();
  return state.sound;
}

/// Finds the squares that the cone's displacements span.
__device__ inline void find_boxes(LightModel const& model, CorrectedCone const& cone, ConeState& state,
                                  ConeLight* kept) {
  double const per_side = 1 / model.box_side();
  BoxRange boxes;
  for (int place = threadIdx.x / warp_size; place < model.places.count; place += dot_warps) {
    visit_cone(model, cone, state, place, kept, false, [&](ConeLight const& light) { boxes.include(light, per_side); });
  }
  if (threadIdx.x == 0) state.boxes = {};
  __syncthreads();
  atomicMin(&state.boxes.low.x, boxes.low.x);
  atomicMin(&state.boxes.low.y, boxes.low.y);
  atomicMax(&state.boxes.high.x, boxes.high.x);
  atomicMax(&state.boxes.high.y, boxes.high.y);
  __syncthreads();
}

/// Moments of the part of the cone whose displacements lie in one square, about its middle. @return whether there is
/// any
__device__ inline bool integrate_box(LightModel const& model, CorrectedCone const& cone, ConeState& state,
                                     ConeLight* kept, Vec2<int> which, Vec2d middle) {
  int const warp = threadIdx.x / warp_size;
  double const per_side = 1 / model.box_side();
  bool any = false;
  for (int place = warp; place < model.places.count; place += dot_warps) {
    DisplacementMoments moments;
    visit_cone(model, cone, state, place, kept, false, [&](ConeLight const& light) {
      Vec2<int> const box = box_of(light.displacement, per_side);
      if (box.x != which.x || box.y != which.y) return;
      moments.add(light.weight, light.displacement - middle);
      any = true;
    });
    keep_moments(state, place, moments);
    if (threadIdx.x % warp_size == 0) cone.finish(state.moments[place], state.without_medium[place]);
  }
  return __syncthreads_or(any);
}

/// Makes state.field of state.moments.
__device__ inline void fit_moments(LightModel const& model, ConeState& state) {
  constexpr int terms = PlaceRule::terms;
  __syncthreads();
  for (int i = threadIdx.x; i < DisplacementMoments::count * terms; i += dot_threads) {
    state.field.coefficient[i / terms][i % terms] =
        MomentField::fitted(model.places, state.moments, i / terms, i % terms);
  }
  __syncthreads();
}

/// Lays down the source's disc with the spots that the moments make of it. A warp takes some points of the source at a
/// time: first its lanes work out all their pixels' edges, then the spots' factors, then a lane a pixel.
/// @param scratch of the warps @param moved where the moments count from [px]
__device__ inline void lay_down_part(LightModel const& model, CubatureView const& source, DotPlan const& plan,
                                     MomentField const& field, Vec2d moved, Patch const& patch,
                                     DeviceImages const& images, SharesOfGroup* scratch) {
  using M = DisplacementMoments;
  using Spot = GaussianSpot<double>;
  constexpr int orders = M::order + 1, most_group = 4;
  int const lane = threadIdx.x % warp_size, warp = threadIdx.x / warp_size;
  Spot const spot = model.spot.gaussian;
  double const per_sigma = 1 / spot.sigma;
  int const width = 2 * spot.half_width() + 1, edges = width + 1;
  int const room_of_point = 2 * orders * edges + M::count;
  int const group = min(most_group, SharesOfGroup::room / room_of_point);
  double* const gathered = patch.of_warp(warp);
  auto const place = [&](int point) {
    Deposit light = reference_light(model, source, plan, point);
    light.at += moved;
    if (!(fabs(light.at.x) < 1e8 && fabs(light.at.y) < 1e8)) light = {};
    return light;
  };
  for (int first = warp * group; first < source.count; first += dot_warps * group) {
    int const here = min(group, source.count - first);
    // factors of a point: [axis][order][edge], then its moments
    auto const factors = [&](int which) { return scratch[warp].of + which * room_of_point; };
    for (int row = lane / 8; row < 2 * here; row += warp_size / 8) {
      int const which = row / 2, axis = row % 2;
      Deposit const light = place(first + which);
      Footprint const reach = spot.footprint(light.at);
      double const from = axis == 0 ? reach.column - light.at.x : reach.row - light.at.y;
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

/// Lays down the light of a cone that integrate_cone() found sound and kept, square by square. @return false: there are
/// too many, and nothing was done
__device__ inline bool expose_wide(LightModel const& model, DotPlan const& plan, CorrectedCone const& cone,
                                   ConeState& state, ConeLight* kept, Patch& patch, DeviceImages const& images,
                                   SharesOfGroup* scratch) {
  find_boxes(model, cone, state, kept);
  BoxRange const boxes = state.boxes;
  if (!boxes.few()) return false;
  patch.begin(plan.origin + cone.origin());
  for (int row = boxes.low.y; row <= boxes.high.y; ++row) {
    for (int column = boxes.low.x; column <= boxes.high.x; ++column) {
      Vec2d const middle{column * model.box_side(), row * model.box_side()};
      __syncthreads();
      if (!integrate_box(model, cone, state, kept, {column, row}, middle)) continue;
      fit_moments(model, state);
      lay_down_part(model, model.wide_source, plan, state.field, cone.origin() + middle, patch, images, scratch);
    }
  }
  patch.flush(images, Frame::flow);
  return true;
}

}  // namespace gladstone::cuda
