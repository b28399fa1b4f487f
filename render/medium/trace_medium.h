#pragma once

#include <cmath>
#include <limits>

#include "render/base/host_device.h"
#include "render/base/ray.h"
#include "render/medium/ray_equation.h"

namespace gladstone::inline medium {

/// Boundary condition for rays at the faces of the medium.
enum class Faces : int {
  matched,  ///< index-matched surroundings: the direction does not change
  refract,  ///< refraction by Snell's law against the ambient index n_0
};

/// Parameters of the ray integration, equal for all rays of a launch.
template <class T>
struct TracingOptions {
  T step{};                  ///< maximum step, as arc length [m]
  T ambient_refractivity{};  ///< n_0 - 1 [1]
  Integrator integrator = Integrator::rk4;
  Faces faces = Faces::matched;
};

/// Path of a ray through a medium, stored as its deviation from the undeflected ray: with t the sum of Sharma's steps,
/// R = entry point + T_0 t + shift and T = T_0 + turn, T_0 in the direction of the incoming ray. In a uniform medium
/// the deviations are exactly zero.
template <class T>
struct MediumPassage {
  RayStatus status = RayStatus::alive;
  bool crossed = false;  ///< false: the ray misses the medium and is unchanged
  Vec3<T> straight{};    ///< optical direction T_0 of the undeflected ray [1]
  T entry{};             ///< distance from the ray's start to the medium, divided by |T_0| [m]
  T t{};                 ///< sum of the steps dt = ds/n in the medium [m]
  Vec3<T> shift{};       ///< deviation of the position [m]
  Vec3<T> turn{};        ///< deviation of the optical direction [1]
  T optical_path{};      ///< optical path length from the ray's start to the exit from the medium [m]
};

/// Returns the position at which the ray exits the medium [m].
template <class T>
GLADSTONE_HD Vec3<T> exit_position(Ray<T> const& start, MediumPassage<T> const& way) {
  return start.position + way.straight * (way.entry + way.t) + way.shift;
}

/// Returns the unit direction of the outgoing ray; exactly the incoming direction if the ray was not deflected.
template <class T>
GLADSTONE_HD Vec3<T> exit_direction(Ray<T> const& start, MediumPassage<T> const& way) {
  // unit(T) - d = (turn - d (|T| - |T_0|)) / |T|, without cancellation
  T const before = length(way.straight);
  T const after = length(way.straight + way.turn);
  T const growth = (T(2) * dot(way.straight, way.turn) + dot(way.turn, way.turn)) / (after + before);
  return start.direction + (way.turn - start.direction * growth) / after;
}

/// Returns the apparent ray: the outgoing ray, traced back in a straight line to the plane z = const of the start. Its
/// position is the apparent position of a dot. @pre the outgoing ray has a z component
template <class T>
GLADSTONE_HD Ray<T> apparent_ray(Ray<T> const& start, MediumPassage<T> const& way) {
  if (!way.crossed) return start;
  T const S = way.entry + way.t;
  Vec3<T> const outgoing = way.straight + way.turn;
  T const rise = way.straight.z * S + way.shift.z;
  // exit - outgoing rise / outgoing.z - start, with the cancelling terms removed
  Vec3<T> const numerator = way.straight * (S * way.turn.z - way.shift.z) - way.turn * rise;
  Vec3<T> const moved = way.shift + numerator / outgoing.z;
  return {{start.position.x + moved.x, start.position.y + moved.y, start.position.z}, exit_direction(start, way)};
}

/// Intersection of a straight line with a box. The line misses the box if enter >= leave.
template <class T>
struct Chord {
  T enter;         ///< distance to the entry, in multiples of the direction vector
  T leave;         ///< distance to the exit, in multiples of the direction vector
  int entry_axis;  ///< axis normal to the entry face; -1: the start is inside
};

/// Returns the intersection of the line from p along d with a box; enter is at least 0.
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

namespace detail {

/// Distance along T from R to the next face, as Sharma's t [m], and the axis normal to that face.
template <class T>
struct FaceExit {
  T t;
  int axis;
};

template <class T>
GLADSTONE_HD FaceExit<T> find_face_exit(Bounds<T> const& box, Vec3<T> R, Vec3<T> direction) {
  FaceExit<T> out{T(unbounded), 2};
  for (int axis = 0; axis < 3; ++axis) {
    if (direction[axis] == T(0)) continue;
    T const face = direction[axis] > T(0) ? box.high[axis] : box.low[axis];
    T const t = (face - R[axis]) / direction[axis];
    if (t < out.t) out = {t, axis};
  }
  return out;
}

/// Returns the axis normal to the face through which a ray at R with the given direction has left a box, or -1 if it
/// has not. A point just outside a face by rounding counts as inside if the ray is directed inwards.
template <class T>
GLADSTONE_HD int find_exit_face(Bounds<T> const& box, Vec3<T> R, Vec3<T> direction) {
  for (int axis = 2; axis >= 0; --axis) {
    if (R[axis] < box.low[axis] && direction[axis] < T(0)) return axis;
    if (R[axis] > box.high[axis] && direction[axis] > T(0)) return axis;
  }
  return -1;
}

/// Computes the change of the optical direction's component normal to a face where n^2 changes from from_n2 = |T|^2 to
/// to_n2; the tangential components are conserved (Snell's law). @return false for total internal reflection
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

/// Part of an integration step that is inside a box.
template <class T>
struct PartialStep {
  bool leaves;  ///< false: the whole step is inside
  T step;       ///< step dt to the exit, or the whole step [m]
  StepIncrement<T> add;
  int axis;  ///< axis normal to the exit face
};

/// Determines by bisection where a curved step leaves the box, for the rare grazing rays. Not inlined, to keep the loop
/// over steps small.
template <class T, class Medium>
[[gnu::noinline]] GLADSTONE_HD PartialStep<T> bisect_exit(Medium const& medium, Integrator integrator,
                                                          Bounds<T> const& box, RayState<T> from, T dt) {
  PartialStep<T> part{false, dt, {}, 2};
  T inside = T(0), next = dt;
  for (int trial = 0; trial <= 64; ++trial) {
    StepIncrement<T> const add = step_increment(medium, integrator, from.position, from.optical_direction, next);
    Vec3<T> const reached = from.position + from.optical_direction * next + add.position;
    int const left_by = find_exit_face(box, reached, from.optical_direction + add.optical_direction);
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

/// State of a ray in the medium: path so far and remaining steps.
template <class T>
struct Crossing {
  MediumPassage<T> way;
  Bounds<T> box{};
  T whole_step{};      ///< full step dt [m]
  T dt{};              ///< next step dt [m]
  int steps_left = 0;  ///< maximum number of remaining steps; 0: the ray is finished
};

/// A step ends at the face if the face is within this multiple of the step.
template <class T>
inline constexpr T landing_margin = T(1) + T(16) * std::numeric_limits<T>::epsilon();

/// Returns true if a point is strictly inside a box.
template <class T>
GLADSTONE_HD bool lies_inside(Bounds<T> const& box, Vec3<T> p) {
  return p.x > box.low.x && p.x < box.high.x && p.y > box.low.y && p.y < box.high.y && p.z > box.low.z &&
         p.z < box.high.z;
}

/// Returns false if a straight step dt certainly ends inside the box. Cheaper than find_face_exit(), which divides.
template <class T>
GLADSTONE_HD bool may_reach_face(Bounds<T> const& box, Vec3<T> R, Vec3<T> direction, T dt) {
  return !lies_inside(box, R + direction * (dt * T(1 + 1e-9)));
}

/// Advances a ray to the entry face, and determines its step sizes.
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

  // use full steps, and divide the remainder of the chord equally between the first and the last step
  using std::floor;
  T const chord_t = (chord.leave - chord.enter) / n_entry;
  T const whole_step = crossing.whole_step = options.step / n_entry;
  T const whole_steps = floor(chord_t / whole_step + T(1e-6));
  T const rest = chord_t - whole_steps * whole_step;
  // on an infinite axis no last step exists, and the remainder is meaningless
  T const countable = T(1e6);
  crossing.dt = whole_steps < countable && rest > T(1e-6) * whole_step ? T(0.5) * rest : whole_step;
  crossing.steps_left = 64 + 16 * static_cast<int>(whole_steps < countable ? whole_steps : countable);
  if (!(n_entry > T(0))) {  // far out in an infinite linear gradient, where n <= 0
    way.status = RayStatus::lost_in_medium;
    crossing.steps_left = 0;
  }
  return crossing;
}

/// Integrates a ray from its current state to its exit from the medium. Not inlined, to limit the register use of a
/// device's loop over full steps.
template <class T, class Medium>
[[gnu::noinline]] GLADSTONE_HD void integrate_to_exit(Medium const& medium, TracingOptions<T> const& options,
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
    FaceExit<T> out{T(unbounded), 2};
    if (may_reach_face(box, where, along, dt)) out = find_face_exit(box, where, along);
    bool landing = out.t <= dt * landing_margin<T>;
    T step = dt;
    if (landing) step = out.t;
    StepIncrement<T> add = step_increment(medium, options.integrator, where, along, step);
    if (!landing) {
      Vec3<T> const reached = where + along * step + add.position;
      int const left_by = find_exit_face(box, reached, along + add.optical_direction);
      if (options.integrator != Integrator::straight && left_by >= 0) {
        // a curved ray left the box within the step: end the step on the crossed face
        landing = true;
        out.axis = left_by;
      }
    }
    if (landing && options.integrator != Integrator::straight) {
      // Newton iteration for the step length; the remainder is corrected by a Taylor series about the end of the step
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
        // a grazing ray, deflected away from the face ahead: use the full step, or the part of it that is inside
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

/// Integrates several rays together through the interior of a medium, until one of them may reach a face in the next
/// step. integrate_to_exit() integrates the remaining steps.
template <class T, class Medium, int N>
GLADSTONE_HD void integrate_together(Medium const& medium, Ray<T> const (&start)[N], Crossing<T> (&crossing)[N]) {
  // local copies, for a device's registers
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
      stay &= find_exit_face(box, R[i] + direction[i] * dt[i] + add[i].position,
                             direction[i] + add[i].optical_direction) < 0;
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

/// Media that sample two neighbouring points at little more than the cost of one.
template <class T, class Medium>
concept SamplesPairs = requires(Medium const& medium, Vec3<T> p, IndexSample<T> (&at)[2]) {
  medium.sample_pair(p, p, at);
};

/// Like integrate_together() for a single ray, but samples the end of a step together with the start of the next one.
/// The two points are (A - B) dt^2/6 apart, and neither sample depends on the other.
template <class T, class Medium>
GLADSTONE_HD void integrate_in_pairs(Medium const& medium, Ray<T> const& start, Crossing<T>& crossing) {
  Crossing<T> ray = crossing;
  MediumPassage<T>& way = ray.way;
  Bounds<T> const box = medium.bounds();
  Vec3<T> R = start.position + way.straight * (way.entry + way.t) + way.shift;
  Force<T> A = compute_force(medium.sample(R));
  while (ray.steps_left > 1) {
    T const dt = ray.dt, dt2 = dt * dt;
    Vec3<T> const direction = way.straight + way.turn;
    if (may_reach_face(box, R, direction, dt)) break;
    Force<T> const B = compute_force(medium.sample(R + (T(0.5) * dt) * direction + (T(0.125) * dt2) * A.d));
    Vec3<T> const moved = (T(1.0 / 6.0) * dt2) * (A.d + T(2) * B.d);
    Vec3<T> const straight_on = R + dt * direction, reached = straight_on + moved;
    IndexSample<T> at[2];
    medium.sample_pair(straight_on + (T(0.5) * dt2) * B.d, reached, at);
    Force<T> const C = compute_force(at[0]);
    Vec3<T> const turned = (T(1.0 / 6.0) * dt) * (A.d + T(4) * B.d + C.d);
    if (!lies_inside(box, reached) && find_exit_face(box, reached, direction + turned) >= 0) break;
    way.shift += way.turn * dt + moved;
    way.turn += turned;
    way.optical_path += (T(1.0 / 6.0) * dt) * (A.n2 + T(4) * B.n2 + C.n2);
    way.t += dt;
    R = reached;
    A = compute_force(at[1]);
    ray.dt = ray.whole_step;
    --ray.steps_left;
  }
  crossing = ray;
}

}  // namespace detail

/// Traces a ray through a medium: straight to the entry face, along the ray equation with steps of at most
/// options.step, and exactly to the exit face. On a straight ray, the first and last steps are partial and of equal
/// length, so that the reversed ray samples the same points.
/// @param start  ray in the ambient, with a unit direction [m]; a ray that starts inside the medium is not refracted
/// at its start
/// @return path of the ray; its status is total_internal_reflection, or lost_in_medium if it does not reach an exit
/// face
template <class T, class Medium>
GLADSTONE_HD MediumPassage<T> trace_medium(Medium const& medium, TracingOptions<T> const& options,
                                           Ray<T> const& start) {
  detail::Crossing<T> crossing = detail::enter_medium(medium, options, start);
  detail::integrate_to_exit(medium, options, start, crossing);
  return crossing.way;
}

/// Like trace_medium() above, for N rays together. Each step of a ray depends on its previous samples; interleaving
/// several rays hides the latency of the samples.
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
      detail::integrate_in_pairs(medium, start[0], crossing[0]);
    } else {
      detail::integrate_together(medium, start, crossing);
    }
  }
  for (int i = 0; i < N; ++i) {
    detail::integrate_to_exit(medium, options, start[i], crossing[i]);
    way[i] = crossing[i].way;
  }
}

}  // namespace gladstone::inline medium
