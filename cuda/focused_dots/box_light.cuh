#pragma once

#include "cuda/focused_dots/cone_light.cuh"

/// Light of a dot whose displacements are sorted into squares (MomentImages), by a whole block: what
/// DotIntegrator::deposit_wide does on the CPU.
namespace gladstone::cuda {

/// What the block's threads have in common while they do.
struct BoxState {
  static constexpr int group = 4;  ///< squares whose light is worked out together
  static constexpr int most = BoxRange::most;
  BoxRange range;
  int listed;                                         ///< squares of a phase that light falls on
  unsigned short list[most];                          ///< their indices
  unsigned short ends[PlaceRule::most_places][most];  ///< of a square's points among a place's in order
  DisplacementMoments moments[group][PlaceRule::most_places];
  double shares[DisplacementMoments::count * PlaceRule::terms][group];  ///< of the images in a square's light

  __device__ int begin(int place, int box) const { return box > 0 ? ends[place][box - 1] : 0; }
};

/// The points of a wide cone.
struct ConePoints {
  ConeLight* light;       ///< [place][count]
  unsigned short* order;  ///< [place][count]: by square
  int count;
};

/// Puts a place's points in the order of their squares, by a warp; within a square they stay in their order.
/// @param ends receives where each square's points end
__device__ inline void sort_points(DotBoxes const& boxes, BoxRange const& range, ConeLight const* light, int count,
                                   unsigned short* order, unsigned short* ends) {
  unsigned const lane = threadIdx.x % warp_size;
  // calls visit(point, square, lanes with the same square, how many of them come before)
  auto const visit_points = [&](auto const& visit) {
    for (int base = 0; base < count; base += warp_size) {
      int const k = base + static_cast<int>(lane);
      int box = -1;
      if (k < count && light[k].weight != 0) box = range.index(boxes.box_of(light[k].displacement));
      unsigned const same = __match_any_sync(whole_warp, box);
      visit(k, box, same, __popc(same & ((1u << lane) - 1u)));
      __syncwarp();
    }
  };
  for (int box = static_cast<int>(lane); box < range.count(); box += warp_size) ends[box] = 0;
  __syncwarp();
  visit_points([&](int, int box, unsigned same, int before) {
    if (box >= 0 && before == 0) ends[box] = static_cast<unsigned short>(ends[box] + __popc(same));
  });
  int all = 0;
  for (int base = 0; base < range.count(); base += warp_size) {
    int const box = base + static_cast<int>(lane);
    int const here = box < range.count() ? ends[box] : 0;
    int sum = here;
    for (unsigned step = 1; step < warp_size; step *= 2) {
      int const lower = __shfl_up_sync(whole_warp, sum, step);
      if (lane >= step) sum += lower;
    }
    if (box < range.count()) ends[box] = static_cast<unsigned short>(all + sum - here);
    all += __shfl_sync(whole_warp, sum, warp_size - 1);
  }
  __syncwarp();
  visit_points([&](int k, int box, unsigned same, int before) {
    int const first = box >= 0 ? ends[box] : 0;
    __syncwarp();
    if (box < 0) return;
    order[first + before] = static_cast<unsigned short>(k);
    if (before == 0) ends[box] = static_cast<unsigned short>(first + __popc(same));
  });
}

/// Lists the squares of a phase that light falls on, in any order.
__device__ inline void list_boxes(DotModel const& model, DotBoxes const& boxes, int phase, BoxState& state) {
  if (threadIdx.x == 0) state.listed = 0;
  __syncthreads();
  int const count = state.range.count();
  for (int box = threadIdx.x; box < count; box += dot_threads) {
    Vec2<int> const square = boxes.square(state.range.box(box));
    if (boxes.lattice.phase(square.y) * boxes.lattice.per_pixel + boxes.lattice.phase(square.x) != phase) continue;
    bool lit = false;
    for (int place = 0; place < model.places.count; ++place) {
      lit = lit || state.ends[place][box] > state.begin(place, box);
    }
    if (lit) state.list[atomicAdd(&state.listed, 1)] = static_cast<unsigned short>(box);
  }
  __syncthreads();
}

/// Moments of some squares' displacements at each place of the source, eight lanes to a square and place.
/// @param list of squares, `here` of them
__device__ inline void sum_boxes(DotModel const& model, CorrectedCone const& cone, double const* without_medium,
                                 DotBoxes const& boxes, ConePoints const& points, unsigned short const* list, int here,
                                 BoxState& state) {
  constexpr int team = 8, teams = dot_threads / team;
  int const member = static_cast<int>(threadIdx.x) % team, tasks = here * model.places.count;
  for (int first = 0; first < tasks; first += teams) {
    int const task = first + static_cast<int>(threadIdx.x) / team;
    int const which = min(task / model.places.count, here - 1), place = task % model.places.count;
    int const box = list[which], end = task < tasks ? state.ends[place][box] : 0;
    Vec2<int> const place_of_box = state.range.box(box);
    DisplacementMoments moments;
    for (int i = state.begin(place, box) + member; i < end; i += team) {
      ConeLight const& light = points.light[place * points.count + points.order[place * points.count + i]];
      moments.add(light.weight, boxes.from_middle(light.displacement, place_of_box));
    }
#pragma unroll
    for (double& moment : moments.of) {
#pragma unroll
      for (int step = team / 2; step > 0; step /= 2) moment += __shfl_xor_sync(whole_warp, moment, step);
    }
    if (task >= tasks) continue;
    cone.finish(moments, without_medium[place]);
#pragma unroll
    for (int i = 0; i < DisplacementMoments::count; ++i) {
      if (i % team == member) state.moments[which][place].of[i] = moments.of[i];
    }
  }
}

/// Adds the light of some squares, all of one phase, to the patch: a thread works out a pixel of each.
/// @pre state.shares are theirs
__device__ inline void add_boxes(MomentImages const& of_moments, DotBoxes const& boxes, int phase,
                                 unsigned short const* list, int here, BoxState const& state, Patch const& patch,
                                 DeviceImages const& images) {
  int const width = of_moments.width(), pixels = width * width;
  double* const gathered = patch.of_warp(threadIdx.x / warp_size);
  for (int first = 0; first < pixels; first += dot_threads) {
    int const pixel = first + static_cast<int>(threadIdx.x);
    double light[BoxState::group] = {};
    if (pixel < pixels) {
      double const* of_moment = of_moments.of_phase(phase) + pixel;
      for (int base = 0; base < of_moments.count(); base += DisplacementMoments::count) {
        double part[DisplacementMoments::count];
#pragma unroll
        for (double& value : part) {
          value = __ldg(of_moment);
          of_moment += of_moments.stride;
        }
#pragma unroll
        for (int k = 0; k < DisplacementMoments::count; ++k) {
#pragma unroll
          for (int which = 0; which < BoxState::group; ++which) light[which] += state.shares[base + k][which] * part[k];
        }
      }
    }
#pragma unroll
    for (int which = 0; which < BoxState::group; ++which) {
      if (pixel < pixels && which < here) {
        Vec2<int> const square = boxes.square(state.range.box(list[which]));
        int const column = boxes.lattice.pixel(square.x) - of_moments.half + pixel % width;
        int const row = boxes.lattice.pixel(square.y) - of_moments.half + pixel / width;
        double const share = whole_units(light[which]);
        if (column >= patch.left && row >= patch.top && column < patch.left + patch.side &&
            row < patch.top + patch.side) {
          gathered[(row - patch.top) * patch.side + column - patch.left] += share;
        } else {
          add_light(images, Frame::flow, column, row, share);
        }
      }
      __syncwarp();  // squares overlap
    }
  }
}

/// Lays down the light of a wide cone, whose points integrate_cone() kept.
__device__ inline void expose_boxes(DotModel const& model, DotCone const& dot, CorrectedCone const& cone,
                                    ConeState const& cone_state, ConePoints const& points, BoxState& state,
                                    Patch& patch, DeviceImages const& images) {
  MomentImages const& of_moments = model.moment_images;
  int const places = model.places.count;
  Vec2d const origin = model.to_pixel(dot.centre) + dot.origin;
  SpannedBoxes const spanned(of_moments.lattice, origin, dot.extent);
  DotBoxes const& boxes = spanned.boxes;
  if (threadIdx.x == 0) state.range = spanned.range;
  __syncthreads();
  for (int place = threadIdx.x / warp_size; place < places; place += dot_warps) {
    sort_points(boxes, state.range, points.light + place * points.count, points.count,
                points.order + place * points.count, state.ends[place]);
  }
  patch.begin(origin);
  double const units = dot.light * images.units_per_weight;
  for (int phase = 0; phase < of_moments.phases(); ++phase) {
    list_boxes(model, boxes, phase, state);
    for (int first = 0; first < state.listed; first += BoxState::group) {
      unsigned short const* const list = state.list + first;
      int const here = min(BoxState::group, state.listed - first);
      sum_boxes(model, cone, cone_state.without_medium, boxes, points, list, here, state);
      __syncthreads();
      for (int k = threadIdx.x; k < of_moments.count() * BoxState::group; k += dot_threads) {
        int const image = k / BoxState::group, which = k % BoxState::group;
        state.shares[image][which] =
            which < here ? units * MomentField::fitted(model.places, state.moments[which], image / of_moments.terms,
                                                       image % of_moments.terms)
                         : 0.0;
      }
      __syncthreads();
      add_boxes(of_moments, boxes, phase, list, here, state, patch, images);
    }
    __syncthreads();
  }
  patch.flush(images, Frame::flow);
}

}  // namespace gladstone::cuda
