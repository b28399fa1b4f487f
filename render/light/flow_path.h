#pragma once

#include "render/light/flow.h"

namespace gladstone {

/// Velocity of small heavy particles in a steady flow, to first order of their response time tau: v = u - tau Du/Dt
/// (Maxey, J. Fluid Mech. 174 (1987) 441; Ferry & Balachandar, Int. J. Multiphase Flow 27 (2001) 1199).
struct ParticleVelocity {
  Flow flow;
  double tau = 0;       ///< rho_p d^2 / (18 mu) [s]; 0: they follow the flow
  double interval = 0;  ///< that derivatives along the flow are taken over [s]; @pre > 0 where tau is

  /// Whether the particles' paths are known in closed form, lag and all.
  bool exact() const {
    return flow.kind.visit([](auto const& held) {
      return requires { held.moved(Vec3d{}, 0.0, 0.0); };
    });
  }

  /// [m/s] at a place [m]
  Vec3d operator()(Vec3d p) const {
    Vec3d const u = flow(p);
    return tau > 0 ? u - tau * acceleration(p) : u;
  }
  /// Du/Dt = (u . grad) u [m/s^2].
  Vec3d acceleration(Vec3d p) const {
    Vec3d const way = interval * flow(p);
    return (flow(p + way) - flow(p - way)) / (2 * interval);
  }
  /// The next term of the expansion, tau^2 (D^2 u/Dt^2 + (Du/Dt . grad) u) [m/s]: what first order leaves out.
  Vec3d neglected(Vec3d p) const {
    Vec3d const way = interval * flow(p), a = acceleration(p), aside = interval * interval * a;
    Vec3d const along = (acceleration(p + way) - acceleration(p - way)) / (2 * interval);
    Vec3d const across = (flow(p + aside) - flow(p - aside)) / (2 * interval * interval);
    return tau * tau * (along + across);
  }
};

/// Where a particle is after a time [s], back in time where that is negative: Runge-Kutta of fourth order.
/// @param velocity [m/s] by place [m] @param steps of equal length
template <class Velocity>
Vec3d moved(Velocity const& velocity, Vec3d p, double time, int steps) {
  double const h = time / steps;
  for (int i = 0; i < steps; ++i) {
    Vec3d const a = velocity(p), b = velocity(p + 0.5 * h * a), c = velocity(p + 0.5 * h * b), d = velocity(p + h * c);
    p += (h / 6) * (a + 2.0 * b + 2.0 * c + d);
  }
  return p;
}

/// The same by closed forms where the flow has them; the uniform velocity comes on top.
inline Vec3d moved(ParticleVelocity const& velocity, Vec3d p, double time, int steps) {
  return velocity.flow.kind.visit([&](auto const& held) {
    if constexpr (requires { held.moved(p, time, velocity.tau); }) {
      return held.moved(p, time, velocity.tau) + time * velocity.flow.uniform;
    } else {
      return moved<ParticleVelocity>(velocity, p, time, steps);
    }
  });
}

/// How well the motion over a time is known.
struct PathPlan {
  int steps = 1;
  double error = 0;      ///< largest change of a place when the steps were halved to these [m]
  double lag_error = 0;  ///< largest way by the first term that the lag leaves out [m]
};

}  // namespace gladstone
