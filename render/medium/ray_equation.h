#pragma once

#include "render/base/host_device.h"
#include "render/medium/index_sample.h"

/// Before a loop over a few rays: keep every ray's numbers in registers.
#if defined(__CUDACC__) || defined(__clang__)
#define GLADSTONE_UNROLL _Pragma("unroll")
#else
#define GLADSTONE_UNROLL _Pragma("GCC unroll 8")
#endif

namespace gladstone {

/// How a ray is carried through a medium.
enum class Integrator : int {
  rk4,       ///< Sharma's Runge-Kutta scheme, order 4
  euler,     ///< order 1
  straight,  ///< gradients taken along the undeflected ray (Eq. 9, slice by slice)
};

/// Position and optical direction T = n dR/ds = dR/dt of a ray, t being Sharma's parameter with dt = ds/n.
template <class T>
struct RayState {
  Vec3<T> position;           ///< R [m]
  Vec3<T> optical_direction;  ///< T [1], |T| = n
};

/// What one step adds to the free flight R + T dt.
template <class T>
struct StepIncrement {
  Vec3<T> position;           ///< [m]
  Vec3<T> optical_direction;  ///< [1]
  T optical_path{};           ///< integral of n ds = n^2 dt over the step [m]
  Vec3<T> last_force;         ///< D = n grad n at the end of the step [1/m]
};

/// D = n grad n = grad(n^2)/2 at p, with n^2 (Rajendran et al. eq. 6).
template <class T>
struct Force {
  Vec3<T> d;  ///< [1/m]
  T n2;       ///< n^2 [1]
};
template <class T, class Medium>
[[gnu::always_inline]] GLADSTONE_HD inline Force<T> force_at(Medium const& medium, Vec3<T> p) {
  IndexSample<T> const s = medium.sample(p);
  T const n = T(1) + s.refractivity;
  return {n * s.gradient, n * n};
}

/// Sharma's three samples of a step for N rays, stage by stage, so that no ray's samples wait for another's.
/// @param bent 1: rk4; 0: the gradients are taken along the undeflected ray
template <class T, class Medium, int N>
GLADSTONE_HD void step_increments(Medium const& medium, T bent, Vec3<T> const (&R)[N], Vec3<T> const (&direction)[N],
                                  T const (&dt)[N], StepIncrement<T> (&add)[N]) {
  Force<T> first[N], middle[N], last[N];
  GLADSTONE_UNROLL
  for (int i = 0; i < N; ++i) first[i] = force_at<T>(medium, R[i]);
  GLADSTONE_UNROLL
  for (int i = 0; i < N; ++i) {
    Vec3<T> const A = first[i].d * dt[i];
    middle[i] = force_at<T>(medium, R[i] + (T(0.5) * direction[i] + (bent * T(0.125)) * A) * dt[i]);
  }
  GLADSTONE_UNROLL
  for (int i = 0; i < N; ++i) {
    Vec3<T> const B = middle[i].d * dt[i];
    last[i] = force_at<T>(medium, R[i] + (direction[i] + (bent * T(0.5)) * B) * dt[i]);
  }
  T const sixth = T(1.0 / 6.0);
  GLADSTONE_UNROLL
  for (int i = 0; i < N; ++i) {
    Vec3<T> const A = first[i].d * dt[i], B = middle[i].d * dt[i], C = last[i].d * dt[i];
    add[i] = {(sixth * dt[i]) * (A + T(2) * B), sixth * (A + T(4) * B + C),
              (sixth * dt[i]) * (first[i].n2 + T(4) * middle[i].n2 + last[i].n2), last[i].d};
  }
}

/// The increments of one step of the ray equation d2R/dt2 = n grad n, dt = ds/n.
/// rk4: Sharma, Kumar & Ghatak, Appl. Opt. 21 (1982) 984; Rajendran et al. eqs. 3-6, where the printed step is Sharma's
/// dt, not arc length, and T_n is T_i.
/// @param medium gives refractivity and gradient [1/m] at p [m]
/// @param R      position [m]; T optical direction [1]
/// @param dt     step [m]; not arc length: ds = n dt. Local error O(dt^5) for rk4, O(dt^2) for euler
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

/// One whole step: the state after Sharma's dt.
template <class T, class Medium>
GLADSTONE_HD RayState<T> advance(Medium const& medium, RayState<T> ray, T dt, Integrator integrator = Integrator::rk4) {
  StepIncrement<T> const add = step_increment(medium, integrator, ray.position, ray.optical_direction, dt);
  return {ray.position + ray.optical_direction * dt + add.position, ray.optical_direction + add.optical_direction};
}

}  // namespace gladstone
