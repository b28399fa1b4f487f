#pragma once

#include <cmath>
#include <limits>

#include "render/base/host_device.h"
#include "render/base/ray.h"
#include "render/medium/ray_equation.h"

namespace gladstone {

/// What a ray does at the faces of the medium.
enum class Faces : int {
  matched,  ///< the surroundings are index-matched: the direction goes on unchanged
  refract,  ///< Snell's law against the ambient index n_0
};

/// How rays are carried through a medium; the same for all rays of a launch.
template <class T>
struct TracingOptions {
  T step{};                  ///< largest step, as arc length [m]
  T ambient_refractivity{};  ///< n_0 - 1 [1]
  Integrator integrator = Integrator::rk4;
  Faces faces = Faces::matched;
};

/// A ray's way through a medium, kept as its departure from the straight ray it would have been: with t the sum of
/// Sharma's steps, R = entry + T_0 t + shift and T = T_0 + turn, T_0 along the incoming ray. A uniform medium gives
/// exact zeros.
template <class T>
struct MediumPassage {
  RayStatus status = RayStatus::alive;
  bool crossed = false;  ///< false: the ray missed the medium and comes back as it went in
  Vec3<T> straight{};    ///< T_0 [1]
  T entry{};             ///< way from the ray's start to the medium, divided by |T_0| [m]
  T t{};                 ///< [m]
  Vec3<T> shift{};       ///< [m]
  Vec3<T> turn{};        ///< [1]
  T optical_path{};      ///< from the ray's start to where it leaves the medium [m]
};

/// Where the ray leaves the medium [m].
template <class T>
GLADSTONE_HD Vec3<T> exit_position(Ray<T> const& start, MediumPassage<T> const& way) {
  return start.position + way.straight * (way.entry + way.t) + way.shift;
}

/// Unit direction in which the ray leaves; exactly the incoming one where nothing turned it.
template <class T>
GLADSTONE_HD Vec3<T> exit_direction(Ray<T> const& start, MediumPassage<T> const& way) {
  // unit(T) - d = (turn - d (|T| - |T_0|)) / |T|, without the cancellation
  T const before = length(way.straight);
  T const after = length(way.straight + way.turn);
  T const growth = (T(2) * dot(way.straight, way.turn) + dot(way.turn, way.turn)) / (after + before);
  return start.direction + (way.turn - start.direction * growth) / after;
}

/// The straight ray that a camera takes the bent one for: the outgoing line, followed back to the plane z = z of the
/// start (a dot's apparent place). @pre the ray leaves with a z component
template <class T>
GLADSTONE_HD Ray<T> apparent_ray(Ray<T> const& start, MediumPassage<T> const& way) {
  if (!way.crossed) return start;
  T const S = way.entry + way.t;
  Vec3<T> const outgoing = way.straight + way.turn;
  T const rise = way.straight.z * S + way.shift.z;
  // exit - outgoing rise / outgoing.z - start, with the terms that cancel taken out
  Vec3<T> const numerator = way.straight * (S * way.turn.z - way.shift.z) - way.turn * rise;
  Vec3<T> const moved = way.shift + numerator / outgoing.z;
  return {{start.position.x + moved.x, start.position.y + moved.y, start.position.z}, exit_direction(start, way)};
}

namespace detail {

/// Where a straight line is inside a box: [enter, leave] in multiples of the direction; enter >= leave: it misses.
template <class T>
struct Chord {
  T enter;
  T leave;
  int entry_axis;  ///< axis of the face it enters through; -1: it starts inside
};

template <class T>
GLADSTONE_HD Chord<T> chord_in(Bounds<T> const& box, Vec3<T> p, Vec3<T> d) {
  Chord<T> chord{T(0), T(unbounded), -1};
  for (int axis = 0; axis < 3; ++axis) {
    if (d[axis] == T(0)) {
      if (p[axis] < box.low[axis] || p[axis] > box.high[axis]) return {T(1), T(0), -1};
      continue;
    }
    T const to_low = (box.low[axis] - p[axis]) / d[axis];
    T const to_high = (box.high[axis] - p[axis]) / d[axis];
    T const near = to_low < to_high ? to_low : to_high;
    T const far = to_low < to_high ? to_high : to_low;
    if (near > chord.enter) {
      chord.enter = near;
      chord.entry_axis = axis;
    }
    if (far < chord.leave) chord.leave = far;
  }
  return chord;
}

/// Way to the next face along T from R, in units of t, and the face's axis.
template <class T>
struct WayOut {
  T t;
  int axis;
};

template <class T>
GLADSTONE_HD WayOut<T> way_out(Bounds<T> const& box, Vec3<T> R, Vec3<T> direction) {
  WayOut<T> out{T(unbounded), 2};
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == T(0)) continue;
    T const face = direction[axis] > T(0) ? box.high[axis] : box.low[axis];
    T const t = (face - R[axis]) / direction[axis];
    if (t < out.t) out = {t, axis};
  }
  return out;
}

/// Axis of the face by which a ray at R that runs along `direction` has left a box; -1: it has not. A ray that has just
/// entered, and by rounding stands in front of its face, runs towards it.
template <class T>
GLADSTONE_HD int face_left_by(Bounds<T> const& box, Vec3<T> R, Vec3<T> direction) {
  for (int axis = 2; axis >= 0; --axis) {
    if (R[axis] < box.low[axis] && direction[axis] < T(0)) return axis;
    if (R[axis] > box.high[axis] && direction[axis] > T(0)) return axis;
  }
  return -1;
}

/// Change of the optical direction's component along a face's normal when the index goes from |T| = n_from to n_to and
/// the tangential components stay (Snell's law). @return false: total internal reflection
template <class T>
GLADSTONE_HD bool refract_component(Vec3<T> direction, T from_n2, T to_n2, int axis, T& change) {
  using std::sqrt;
  T const normal = direction[axis];
  T const squared = normal * normal + (to_n2 - from_n2);
  if (squared < T(0)) return false;
  T const root = normal < T(0) ? -sqrt(squared) : sqrt(squared);
  change = (to_n2 - from_n2) / (root + normal);
  return true;
}

/// The part of a step that stays inside a box.
template <class T>
struct PartialStep {
  bool leaves;  ///< false: it is the whole step
  T step;       ///< [m]
  StepIncrement<T> add;
  int axis;  ///< of the face where it ends
};

/// Finds where a curved step leaves the box, by bisection: for the rare rays that graze a face. Kept out of line, so
/// that the loop over steps stays small.
template <class T, class Medium>
[[gnu::noinline]] GLADSTONE_HD PartialStep<T> bisect_exit(Medium const& medium, Integrator integrator,
                                                          Bounds<T> const& box, RayState<T> from, T dt) {
  PartialStep<T> part{false, dt, {}, 2};
  T inside = T(0), next = dt;
  for (int trial = 0; trial <= 64; ++trial) {
    StepIncrement<T> const add = step_increment(medium, integrator, from.position, from.optical_direction, next);
    Vec3<T> const reached = from.position + from.optical_direction * next + add.position;
    int const left_by = face_left_by(box, reached, from.optical_direction + add.optical_direction);
    if (trial == 0) part.add = add;
    if (trial == 0 && left_by < 0) return part;
    if (left_by >= 0) {
      part.step = next;
      part.add = add;
      part.axis = left_by;
    } else {
      inside = next;
    }
    next = T(0.5) * (inside + part.step);
  }
  part.leaves = true;
  return part;
}

/// A ray under way: its passage so far, and the steps that are left to take.
template <class T>
struct Crossing {
  MediumPassage<T> way;
  Bounds<T> box{};
  T whole_step{};      ///< [m]
  T dt{};              ///< the next step [m]
  int steps_left = 0;  ///< 0: nothing is left to trace
};

/// A step is the last one if it ends within this share of itself from the face.
template <class T>
inline constexpr T landing_margin = T(1) + T(16) * std::numeric_limits<T>::epsilon();

/// Whether a point is within a box, and on none of its faces.
template <class T>
GLADSTONE_HD bool lies_inside(Bounds<T> const& box, Vec3<T> p) {
  return p.x > box.low.x && p.x < box.high.x && p.y > box.low.y && p.y < box.high.y && p.z > box.low.z &&
         p.z < box.high.z;
}

/// False where a step dt along a straight line surely ends short of every face: cheaper than way_out, which divides.
template <class T>
GLADSTONE_HD bool may_reach_face(Bounds<T> const& box, Vec3<T> R, Vec3<T> direction, T dt) {
  return !lies_inside(box, R + direction * (dt * T(1 + 1e-9)));
}

/// Brings a ray to the face where it enters, and plans its steps.
template <class T, class Medium>
GLADSTONE_HD Crossing<T> enter_medium(Medium const& medium, TracingOptions<T> const& options, Ray<T> const& start) {
  Crossing<T> crossing;
  MediumPassage<T>& way = crossing.way;
  Bounds<T> const box = crossing.box = medium.bounds();
  Chord<T> const chord = chord_in(box, start.position, start.direction);
  way.straight = start.direction;
  if (!(chord.leave > chord.enter)) return crossing;
  way.crossed = true;

  Vec3<T> const entry_point = start.position + start.direction * chord.enter;
  T const n_entry = T(1) + medium.sample(entry_point).refractivity;
  T const n_ambient = T(1) + options.ambient_refractivity;
  bool const refracting = options.faces == Faces::refract;
  T const n_straight = refracting && chord.entry_axis >= 0 ? n_ambient : n_entry;
  way.straight = start.direction * n_straight;
  way.entry = chord.enter / n_straight;
  way.optical_path = n_ambient * chord.enter;
  if (refracting && chord.entry_axis >= 0) {
    T change = T(0);
    if (!refract_component(way.straight, n_ambient * n_ambient, n_entry * n_entry, chord.entry_axis, change)) {
      way.status = RayStatus::total_internal_reflection;
      return crossing;
    }
    way.turn[chord.entry_axis] = change;
  }

  // whole steps, with what remains of the chord halved between the first and the last one
  using std::floor;
  T const chord_t = (chord.leave - chord.enter) / n_entry;
  T const whole_step = crossing.whole_step = options.step / n_entry;
  T const whole_steps = floor(chord_t / whole_step + T(1e-6));
  T const rest = chord_t - whole_steps * whole_step;
  // along an endless axis there is no last step to share with, and the rest of the division means nothing
  T const countable = T(1e6);
  crossing.dt = whole_steps < countable && rest > T(1e-6) * whole_step ? T(0.5) * rest : whole_step;
  crossing.steps_left = 64 + 16 * static_cast<int>(whole_steps < countable ? whole_steps : countable);
  if (!(n_entry > T(0))) {  // far out in an endless gradient, where no step leads anywhere
    way.status = RayStatus::lost_in_medium;
    crossing.steps_left = 0;
  }
  return crossing;
}

/// Takes a ray that has entered to where it leaves. Out of line, so that a device's loop over whole steps keeps its
/// registers.
template <class T, class Medium>
[[gnu::noinline]] GLADSTONE_HD void leave_medium(Medium const& medium, TracingOptions<T> const& options,
                                                 Ray<T> const& start, Crossing<T>& crossing) {
  if (crossing.steps_left == 0) return;
  MediumPassage<T>& way = crossing.way;
  Bounds<T> const& box = crossing.box;
  T const n_ambient = T(1) + options.ambient_refractivity;
  bool const refracting = options.faces == Faces::refract;
  T dt = crossing.dt;
  for (; crossing.steps_left > 0; --crossing.steps_left) {
    Vec3<T> const R = start.position + way.straight * (way.entry + way.t) + way.shift;
    Vec3<T> const direction = way.straight + way.turn;
    Vec3<T> const where =
        options.integrator == Integrator::straight ? start.position + way.straight * (way.entry + way.t) : R;
    Vec3<T> const along = options.integrator == Integrator::straight ? way.straight : direction;
    WayOut<T> out{T(unbounded), 2};
    if (may_reach_face(box, where, along, dt)) out = way_out(box, where, along);
    bool landing = out.t <= dt * landing_margin<T>;
    T step = dt;
    if (landing) step = out.t;
    StepIncrement<T> add = step_increment(medium, options.integrator, where, along, step);
    if (!landing) {
      Vec3<T> const reached = where + along * step + add.position;
      int const left_by = face_left_by(box, reached, along + add.optical_direction);
      if (options.integrator != Integrator::straight && left_by >= 0) {
        // a curved ray left in mid-step: land on the face that it crossed
        landing = true;
        out.axis = left_by;
      }
    }
    if (landing && options.integrator != Integrator::straight) {
      // Newton on the step length; what remains is closed by the Taylor series of the last step's end
      bool landed = false;
      for (int trial = 0; trial < 12; ++trial) {
        T const speed = direction[out.axis] + add.optical_direction[out.axis];
        T const position = R[out.axis] + direction[out.axis] * step + add.position[out.axis];
        T const face = speed > T(0) ? box.high[out.axis] : box.low[out.axis];
        T miss = (face - position) / speed;
        if ((miss < T(0) ? -miss : miss) <= T(1e-4) * step) {
          landed = step <= T(2) * dt;
          miss -= T(0.5) * miss * miss * add.last_force[out.axis] / speed;
          Vec3<T> const end = direction + add.optical_direction;
          add.position += (T(0.5) * miss * miss) * add.last_force + add.optical_direction * miss;
          add.optical_direction += add.last_force * miss;
          add.optical_path += dot(end, end) * miss;
          step += miss;
          break;
        }
        step = step + miss > T(0) ? step + miss : T(0.5) * step;
        if (!(step <= T(2) * dt)) break;
        add = step_increment(medium, options.integrator, where, along, step);
      }
      if (!landed) {
        // a grazing ray, bent away from the face that it was heading for: a whole step, or the part of it that stays
        // inside
        PartialStep<T> const part = bisect_exit(medium, options.integrator, box, {where, along}, dt);
        landing = part.leaves;
        step = part.step;
        add = part.add;
        out.axis = part.axis;
      }
    }
    way.shift += way.turn * step + add.position;
    way.turn += add.optical_direction;
    way.optical_path += add.optical_path;
    way.t += step;
    if (landing) {
      if (refracting) {
        Vec3<T> const leaving = way.straight + way.turn;
        T change = T(0);
        T const n2 = dot(leaving, leaving);
        if (!refract_component(leaving, n2, n_ambient * n_ambient, out.axis, change)) {
          way.status = RayStatus::total_internal_reflection;
          return;
        }
        way.turn[out.axis] += change;
      }
      return;
    }
    dt = crossing.whole_step;
  }
  way.status = RayStatus::lost_in_medium;
}

/// Takes rays that have entered through the middle of a medium in step, as long as all of them are sure to stay inside
/// for one more step: what is special about a last step is left to the single ray.
template <class T, class Medium, int N>
GLADSTONE_HD void cross_together(Medium const& medium, Ray<T> const (&start)[N], Crossing<T> (&crossing)[N]) {
  // copies, so that a device keeps them in registers
  Crossing<T> ray[N];
  for (int i = 0; i < N; ++i) ray[i] = crossing[i];
  Vec3<T> R[N], direction[N];
  T dt[N];
  StepIncrement<T> add[N];
  Bounds<T> const box = medium.bounds();
  while (true) {
    bool stay = true;
    for (int i = 0; i < N; ++i) {
      MediumPassage<T> const& way = ray[i].way;
      R[i] = start[i].position + way.straight * (way.entry + way.t) + way.shift;
      direction[i] = way.straight + way.turn;
      dt[i] = ray[i].dt;
      stay &= ray[i].steps_left > 1 && !may_reach_face(box, R[i], direction[i], dt[i]);
    }
    if (!stay) break;
    step_increments(medium, T(1), R, direction, dt, add);
    for (int i = 0; i < N; ++i) {
      stay &=
          face_left_by(box, R[i] + direction[i] * dt[i] + add[i].position, direction[i] + add[i].optical_direction) < 0;
    }
    if (!stay) break;
    for (int i = 0; i < N; ++i) {
      MediumPassage<T>& way = ray[i].way;
      way.shift += way.turn * dt[i] + add[i].position;
      way.turn += add[i].optical_direction;
      way.optical_path += add[i].optical_path;
      way.t += dt[i];
      ray[i].dt = ray[i].whole_step;
      --ray[i].steps_left;
    }
  }
  for (int i = 0; i < N; ++i) crossing[i] = ray[i];
}

/// Media that sample two points which lie near each other for little more than one.
template <class T, class Medium>
concept SamplesPairs = requires(Medium const& medium, Vec3<T> p, IndexSample<T> (&at)[2]) {
  medium.sample_beside(p, p, at);
};

/// The same steps for one ray, with a step's last sample taken together with the next one's first: they lie
/// (A - B) dt^2/6 apart, and neither waits for the other. Leaves the last steps as cross_together does.
template <class T, class Medium>
GLADSTONE_HD void cross_in_pairs(Medium const& medium, Ray<T> const& start, Crossing<T>& crossing) {
  Crossing<T> ray = crossing;
  MediumPassage<T>& way = ray.way;
  Bounds<T> const box = medium.bounds();
  Vec3<T> R = start.position + way.straight * (way.entry + way.t) + way.shift;
  Force<T> A = force_of(medium.sample(R));
  while (ray.steps_left > 1) {
    T const dt = ray.dt, dt2 = dt * dt;
    Vec3<T> const direction = way.straight + way.turn;
    if (may_reach_face(box, R, direction, dt)) break;
    Force<T> const B = force_of(medium.sample(R + (T(0.5) * dt) * direction + (T(0.125) * dt2) * A.d));
    Vec3<T> const moved = (T(1.0 / 6.0) * dt2) * (A.d + T(2) * B.d);
    Vec3<T> const straight_on = R + dt * direction, reached = straight_on + moved;
    IndexSample<T> at[2];
    medium.sample_beside(straight_on + (T(0.5) * dt2) * B.d, reached, at);
    Force<T> const C = force_of(at[0]);
    Vec3<T> const turned = (T(1.0 / 6.0) * dt) * (A.d + T(4) * B.d + C.d);
    if (!lies_inside(box, reached) && face_left_by(box, reached, direction + turned) >= 0) break;
    way.shift += way.turn * dt + moved;
    way.turn += turned;
    way.optical_path += (T(1.0 / 6.0) * dt) * (A.n2 + T(4) * B.n2 + C.n2);
    way.t += dt;
    R = reached;
    A = force_of(at[1]);
    ray.dt = ray.whole_step;
    --ray.steps_left;
  }
  crossing = ray;
}

}  // namespace detail

/// Carries a ray through a medium: straight to its face, along the ray equation with steps of at most options.step
/// (first and last step partial and equally long on a straight ray, so that a reversed ray meets the same points),
/// exactly to the face where it leaves.
/// @param start any ray in the ambient [m, unit direction]; one that starts inside starts at full index there
/// @return the passage; status total_internal_reflection or lost_in_medium (trapped) where it does not come out
template <class T, class Medium>
GLADSTONE_HD MediumPassage<T> trace_medium(Medium const& medium, TracingOptions<T> const& options,
                                           Ray<T> const& start) {
  detail::Crossing<T> crossing = detail::enter_medium(medium, options, start);
  detail::leave_medium(medium, options, start, crossing);
  return crossing.way;
}

/// The same for N rays side by side. A step waits for its own samples of the medium, one after the other; with several
/// rays in step a processor works on one while another waits.
template <class T, class Medium, int N>
GLADSTONE_HD void trace_medium(Medium const& medium, TracingOptions<T> const& options, Ray<T> const (&start)[N],
                               MediumPassage<T> (&way)[N]) {
  detail::Crossing<T> crossing[N];
  bool together = options.integrator == Integrator::rk4;
  for (int i = 0; i < N; ++i) {
    crossing[i] = detail::enter_medium(medium, options, start[i]);
    together &= crossing[i].steps_left > 0;
  }
  if (together) {
    if constexpr (N == 1 && detail::SamplesPairs<T, Medium>) {
      detail::cross_in_pairs(medium, start[0], crossing[0]);
    } else {
      detail::cross_together(medium, start, crossing);
    }
  }
  for (int i = 0; i < N; ++i) {
    detail::leave_medium(medium, options, start[i], crossing[i]);
    way[i] = crossing[i].way;
  }
}

}  // namespace gladstone
