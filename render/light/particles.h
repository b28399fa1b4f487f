#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "render/light/flow_path.h"
#include "render/light/laser_sheet.h"
#include "render/light/particle_setup.h"

namespace gladstone {

/// Particles at both pulses.
struct Particles {
  std::vector<Vec3d> place[2];     ///< [m]
  std::vector<double> photons[2];  ///< per area, that either pulse brings there [1/m^2]; 0: outside volume or sheet
  std::vector<double> diameter;    ///< [m]
  PathPlan path;                   ///< how well `place` is known
  std::size_t outside_flow = 0;    ///< of them, those that are where a file's velocity has ended, at either pulse

  std::size_t size() const { return diameter.size(); }
  void resize(std::size_t count);
  /// Keeps particle `from` as number `to`.
  void copy(std::size_t from, std::size_t to);
};

/// Memory that a particle takes with its truth, images aside [bytes].
inline constexpr double bytes_per_particle = 450;

/// By how much the motion over half the time between the pulses reaches at most about a volume, to either side of it
/// [m]: a fourth more than on a lattice of places in it.
Vec3d motion_margin(FlowSetup const& flow, Vec3d volume, Vec3d center);

/// Random particles in a volume, `count` of them at either pulse on average: seeded at mid-time over the volume and
/// what moves into it, and moved from there by -dt/2 and +dt/2 along the flow; uniformly, but behind a shock, where
/// they crowd as continuity of their own flow says. Those that are outside at both pulses are left out. A particle
/// depends on the seed and its number alone.
/// @param tolerance that a place is to be known to by halving the steps of its path [m]
/// @pre setup.volume
Particles seed_particles(ParticleSetup const& setup, double count, FlowSetup const& flow,
                         LaserSheet<double> const& sheet, double tolerance);

/// Particles of a file, x_mm,y_mm,z_mm,diameter_um: there at the first pulse.
/// @throws DataError for a line that is no particle, with its place
Particles read_particles(ParticleSetup const& setup, FlowSetup const& flow, LaserSheet<double> const& sheet,
                         double tolerance);

/// Diameters drawn for `count` particles [m], all positive. @throws DataError of a table's file
std::vector<double> draw_diameters(DiameterSetup const& setup, std::uint64_t seed, std::size_t count);

}  // namespace gladstone
