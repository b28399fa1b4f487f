#pragma once

#include "render/base/host_device.h"
#include "render/base/vec.h"

namespace gladstone::inline setup {
class SetupTable;
}

namespace gladstone::inline light {

struct FlowSetup;

/// Plane front of a steady normal shock, shared by a medium of kind normal_shock and the flow through it.
struct ShockPlane {
  double mach = 1;           ///< upstream Mach number, normal to the front
  double density_ratio = 1;  ///< rho_2 / rho_1 = u_1 / u_2
  double position = 0;       ///< intersection of the front with the X axis [m]
  double tilt = 0;           ///< rotation of the front's normal about the Y axis, from X towards Z [rad]
};

/// Flow through a steady normal shock along its normal, with relaxation of the particles behind it. The gas velocity is
/// u_1 = Mach sqrt(gamma R T_1) upstream and u_2 = u_1 rho_1 / rho_2 downstream; the thickness of the front is
/// neglected. Particles arrive at u_1 and relax as dv/dt = (u_2 - v) / tau (Stokes): a time t after the crossing they
/// are at a distance s = u_2 t + (u_1 - u_2) tau (1 - exp(-t / tau)) behind the front (Raffel et al., Particle Image
/// Velocimetry, 2018, section 2.1). Hence their velocity v and relative number density u_1 / v depend on s alone.
struct NormalShockFlow {
  static constexpr char const* kind = "normal_shock";

  double upstream = 0, downstream = 0;  ///< u_1, u_2 [m/s]
  double position = 0;                  ///< intersection of the front with the X axis [m]
  double normal_x = 1, normal_z = 0;    ///< unit normal of the front, in flow direction

  static NormalShockFlow read(SetupTable& table, FlowSetup& setup);

  template <class T>
  GLADSTONE_HD Vec3<T> operator()(Vec3<T> const& p) const {
    T const s = (p.x - T(position)) * T(normal_x) + p.z * T(normal_z);
    T const u = s < T(0) ? T(upstream) : T(downstream);
    return {u * T(normal_x), T(0), u * T(normal_z)};
  }

  /// Returns the position [m] of a particle after a time [s] (before, if negative). @param tau  response time [s]
  Vec3d moved(Vec3d p, double time, double tau) const;
  /// Returns the particle number density relative to upstream, u_1 / v [1]. For tau = 0 it equals the density ratio of
  /// the gas.
  double crowding(Vec3d p, double tau) const;
  /// Upper bound of crowding() [1].
  double most_crowding() const { return upstream / downstream; }
  /// Returns the mean of crowding() over a box of the given size about a centre [m].
  double mean_crowding(Vec3d volume, Vec3d center, double tau) const;
  /// Upper bound of the particle velocity, per component [m/s].
  Vec3d fastest() const { return {upstream * normal_x, 0, upstream * normal_z}; }

 private:
  double distance(Vec3d p) const { return (p.x - position) * normal_x + p.z * normal_z; }
  /// Distance [m] behind the front at a time [s] after the particle crossed it, and its inverse function. Negative
  /// values are upstream of the front.
  double way_after(double time, double tau) const;
  double time_for(double way, double tau) const;
};

}  // namespace gladstone::inline light
