#pragma once

#include "render/light/flow.h"

namespace gladstone::inline light {

/// Velocity of small heavy particles in a steady flow, to first order in their response time tau: v = u - tau Du/Dt
/// (Maxey, J. Fluid Mech. 174 (1987) 441; Ferry & Balachandar, Int. J. Multiphase Flow 27 (2001) 1199).
struct ParticleVelocity {
  Flow flow;
  double tau = 0;       ///< response time rho_p d^2 / (18 mu) [s]; 0: tracers without lag
  double interval = 0;  ///< time step of the central differences along the flow [s]; @pre > 0 if tau > 0

  /// Returns true if the flow provides the particle paths in closed form, including the lag.
  bool exact() const {
    return flow.kind.visit([](auto const& held) {
      return requires { held.moved(Vec3d{}, 0.0, 0.0); };
    });
  }

  /// Returns the particle velocity [m/s] at a point [m].
  GLADSTONE_HD Vec3d operator()(Vec3d p) const {
    Vec3d const u = flow(p);
    return tau > 0 ? u - tau * acceleration(p) : u;
  }
  /// Returns the material acceleration Du/Dt = (u . grad) u [m/s^2], by central differences along the flow.
  GLADSTONE_HD Vec3d acceleration(Vec3d p) const {
    Vec3d const way = interval * flow(p);
    return (flow(p + way) - flow(p - way)) / (2 * interval);
  }
  /// Returns the second-order term of the expansion, tau^2 (D^2 u/Dt^2 + (Du/Dt . grad) u) [m/s], which operator()
  /// neglects.
  Vec3d neglected(Vec3d p) const {
    Vec3d const way = interval * flow(p), a = acceleration(p), aside = interval * interval * a;
    Vec3d const along = (acceleration(p + way) - acceleration(p - way)) / (2 * interval);
    Vec3d const across = (flow(p + aside) - flow(p - aside)) / (2 * interval * interval);
    return tau * tau * (along + across);
  }
};

/// Integrates the path of a particle over a time [s], backwards if negative, by the classical fourth-order Runge-Kutta
/// scheme.
/// @param velocity  callable, velocity [m/s] at a point [m]
/// @param p         initial position [m]
/// @param steps     number of steps of equal length
/// @return final position [m]
template <class Velocity>
GLADSTONE_HD Vec3d moved(Velocity const& velocity, Vec3d p, double time, int steps) {
  double const h = time / steps;
  for (int i = 0; i < steps; ++i) {
    Vec3d const a = velocity(p), b = velocity(p + 0.5 * h * a), c = velocity(p + 0.5 * h * b), d = velocity(p + h * c);
    p += (h / 6) * (a + 2.0 * b + 2.0 * c + d);
  }
  return p;
}

/// Like moved() above, but uses the closed form of the flow if it has one; the uniform velocity is added to it. For
/// tracers the kind of flow is determined once, not for every velocity.
inline Vec3d moved(ParticleVelocity const& velocity, Vec3d p, double time, int steps) {
  return velocity.flow.kind.visit([&](auto const& held) {
    if constexpr (requires { held.moved(p, time, velocity.tau); }) {
      return held.moved(p, time, velocity.tau) + time * velocity.flow.uniform;
    } else if (velocity.tau > 0) {
      return moved<ParticleVelocity>(velocity, p, time, steps);
    } else {
      return moved([&](Vec3d at) { return held(at) + velocity.flow.uniform; }, p, time, steps);
    }
  });
}

/// Number of integration steps of the particle paths, and their estimated errors.
struct PathPlan {
  int steps = 1;
  double error = 0;      ///< largest change of a final position when the step was last halved [m]
  double lag_error = 0;  ///< largest displacement by the second-order term of the lag, which is neglected [m]
};

}  // namespace gladstone::inline light
