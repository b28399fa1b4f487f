#pragma once

#include "render/base/host_device.h"
#include "render/medium/index_sample.h"

/// GLADSTONE_UNROLL unrolls a loop over a few rays, to keep their data in registers. GLADSTONE_STAGES unrolls the loop
/// over the stages of a step on the host only: on a device a single copy of the sampling code saves registers and
/// instructions. nvcc's host pass does not support these pragmas.
#if defined(__CUDA_ARCH__)
#define GLADSTONE_UNROLL _Pragma("unroll")
#define GLADSTONE_STAGES _Pragma("unroll 1")
#elif defined(__CUDACC__)
#define GLADSTONE_UNROLL
#define GLADSTONE_STAGES
#elif defined(__clang__)
#define GLADSTONE_UNROLL _Pragma("unroll")
#define GLADSTONE_STAGES _Pragma("unroll")
#else
#define GLADSTONE_UNROLL _Pragma("GCC unroll 8")
#define GLADSTONE_STAGES _Pragma("GCC unroll 3")
#endif

namespace gladstone::inline medium {

/// Integration scheme for rays in a medium.
enum class Integrator : int {
  rk4,       ///< Sharma's Runge-Kutta scheme, fourth order
  euler,     ///< explicit Euler scheme, first order
  straight,  ///< gradients integrated along the undeflected ray (Eq. 9 slice by slice)
};

/// Position and optical direction T = n dR/ds = dR/dt of a ray, t being Sharma's parameter with dt = ds/n.
template <class T>
struct RayState {
  Vec3<T> position;           ///< R [m]
  Vec3<T> optical_direction;  ///< T [1], |T| = n
};

/// Increments of one step, in addition to the free flight R + T dt.
template <class T>
struct StepIncrement {
  Vec3<T> position;           ///< increment of R [m]
  Vec3<T> optical_direction;  ///< increment of T [1]
  T optical_path{};           ///< integral of n ds = n^2 dt over the step [m]
  Vec3<T> last_force;         ///< D = n grad n at the end of the step [1/m]
};

/// Force D = n grad n = grad(n^2)/2 at a point (Rajendran et al. 2019, eq. 6), and n^2.
template <class T>
struct Force {
  Vec3<T> d;  ///< force D [1/m]
  T n2;       ///< n^2 [1]
};
template <class T>
[[gnu::always_inline]] GLADSTONE_HD inline Force<T> compute_force(IndexSample<T> const& s) {
  T const n = T(1) + s.refractivity;
  return {n * s.gradient, n * n};
}
template <class T, class Medium>
[[gnu::always_inline]] GLADSTONE_HD inline Force<T> force_at(Medium const& medium, Vec3<T> p) {
  return compute_force<T>(medium.sample(p));
}

/// Evaluates the three stages of Sharma's step for N rays together, so that the samples of different rays are
/// independent.
/// @param bent  1: rk4; 0: gradients along the undeflected ray
template <class T, class Medium, int N>
[[gnu::always_inline]] GLADSTONE_HD inline void step_increments(Medium const& medium, T bent, Vec3<T> const (&R)[N],
                                                                Vec3<T> const (&direction)[N], T const (&dt)[N],
                                                                StepIncrement<T> (&add)[N]) {
  // With the stages' K = dt n grad n = A, B, C: the position increment is dt (A + 2 B)/6, the direction's (A + 4 B +
  // C)/6.
  Vec3<T> K[N]{};
  for (int i = 0; i < N; ++i) add[i] = {};
  GLADSTONE_STAGES
  for (int stage = 0; stage < 3; ++stage) {
    T const along = T(0.5) * T(stage), across = bent * T(stage == 0 ? 0.0 : (stage == 1 ? 0.125 : 0.5));
    T const moves = T(stage == 0 ? 1.0 / 6.0 : (stage == 1 ? 1.0 / 3.0 : 0.0)),
            turns = T(stage == 1 ? 2.0 / 3.0 : 1.0 / 6.0);
    GLADSTONE_UNROLL
    for (int i = 0; i < N; ++i) {
      Force<T> const force = force_at<T>(medium, R[i] + (along * direction[i] + across * K[i]) * dt[i]);
      K[i] = force.d * dt[i];
      add[i].position += (moves * dt[i]) * K[i];
      add[i].optical_direction += turns * K[i];
      add[i].optical_path += (turns * dt[i]) * force.n2;
      add[i].last_force = force.d;
    }
  }
}

/// Returns the increments of one step of the ray equation d2R/dt2 = n grad n, dt = ds/n.
/// rk4: Sharma, Kumar & Ghatak, Appl. Opt. 21 (1982) 984; Rajendran et al. (2019), eqs. 3-6, where the printed step is
/// Sharma's dt, not arc length, and T_n is T_i.
/// @param medium     provides refractivity and gradient [1/m] at a point [m]
/// @param R          position [m]
/// @param direction  optical direction T [1]
/// @param dt         step [m]; the arc length is ds = n dt. Local error O(dt^5) for rk4, O(dt^2) for euler
template <class T, class Medium>
GLADSTONE_HD StepIncrement<T> step_increment(Medium const& medium, Integrator integrator, Vec3<T> R, Vec3<T> direction,
                                             T dt) {
  if (integrator == Integrator::euler) {
    Force<T> const force = force_at<T>(medium, R);
    return {{}, force.d * dt, force.n2 * dt, force.d};
  }
  Vec3<T> const from[1] = {R}, along[1] = {direction};
  T const step[1] = {dt};
  StepIncrement<T> add[1];
  step_increments(medium, integrator == Integrator::rk4 ? T(1) : T(0), from, along, step, add);
  return add[0];
}

/// Advances a ray by one step dt [m] and returns its new state.
template <class T, class Medium>
GLADSTONE_HD RayState<T> advance(Medium const& medium, RayState<T> ray, T dt, Integrator integrator = Integrator::rk4) {
  StepIncrement<T> const add = step_increment(medium, integrator, ray.position, ray.optical_direction, dt);
  return {ray.position + ray.optical_direction * dt + add.position, ray.optical_direction + add.optical_direction};
}

}  // namespace gladstone::inline medium
