#pragma once

#include <cmath>

#include "render/base/host_device.h"
#include "render/base/vec.h"

namespace gladstone {

class SetupTable;
struct FlowSetup;

/// The front of a medium of kind normal_shock, which the flow through it shares.
struct ShockPlane {
  double mach = 1;           ///< upstream, of the speed across the front
  double density_ratio = 1;  ///< rho_2 / rho_1 = u_1 / u_2
  double position = 0;       ///< where the front cuts the X axis [m]
  double tilt = 0;           ///< of its normal about the Y axis, from X towards Z [rad]
};

/// Gas that crosses a steady normal shock along its normal: u_1 = Mach sqrt(gamma R T_1) before the front, u_2 = u_1
/// rho_1 / rho_2 behind it; the front is thin beside what particles lag. Particles come along with u_1 and relax behind
/// it as dv/dt = (u_2 - v) / tau (Stokes): a time t behind the front they are s = u_2 t + (u_1 - u_2) tau (1 - exp(-t /
/// tau)) away from it (Raffel et al., Particle Image Velocimetry, 2018, section 2.1), and as there are no others, both
/// their velocity and their number per volume, as u_1 / v, follow from s alone.
struct NormalShockFlow {
  static constexpr char const* kind = "normal_shock";

  double upstream = 0, downstream = 0;  ///< u_1, u_2 [m/s]
  double position = 0;                  ///< where the front cuts the X axis [m]
  double normal_x = 1, normal_z = 0;    ///< of the front, along the flow

  static NormalShockFlow read(SetupTable& table, FlowSetup& setup);

  template <class T>
  GLADSTONE_HD Vec3<T> operator()(Vec3<T> const& p) const {
    T const s = (p.x - T(position)) * T(normal_x) + p.z * T(normal_z);
    T const u = s < T(0) ? T(upstream) : T(downstream);
    return {u * T(normal_x), T(0), u * T(normal_z)};
  }

  /// Where a particle of that response time [s] is a time [s] later, or earlier where that is negative.
  Vec3d moved(Vec3d p, double time, double tau) const;
  /// Particles per volume over those upstream, u_1 / v: without lag the ratio of the gas' densities.
  double crowding(Vec3d p, double tau) const;
  double most_crowding() const { return upstream / downstream; }
  /// Its mean over a volume about a centre [m].
  double mean_crowding(Vec3d volume, Vec3d center, double tau) const;
  /// No particle is faster [m/s].
  Vec3d fastest() const { return {upstream * normal_x, 0, upstream * normal_z}; }

 private:
  double distance(Vec3d p) const { return (p.x - position) * normal_x + p.z * normal_z; }
  /// Way behind the front after a time since the particle crossed it, and the time for a way [m, s]; both may be
  /// negative.
  double way_after(double time, double tau) const;
  double time_for(double way, double tau) const;
};

}  // namespace gladstone
