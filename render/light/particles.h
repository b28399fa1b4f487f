#pragma once

#include <cstddef>
#include <vector>

#include "render/light/flow_path.h"
#include "render/light/laser_sheet.h"
#include "render/light/particle_setup.h"

namespace gladstone::inline light {

/// Particles at both laser pulses.
struct Particles {
  std::vector<Vec3d> place[2];     ///< position at each pulse [m]
  std::vector<double> photons[2];  ///< photons per area incident at each pulse [1/m^2]; 0: outside volume or sheet
  std::vector<double> diameter;    ///< particle diameter [m]
  PathPlan path;                   ///< integration steps and errors of the paths
  std::size_t outside_flow = 0;    ///< number of particles outside the velocity field of a file at either pulse

  std::size_t size() const { return diameter.size(); }
  void resize(std::size_t count);
  /// Copies particle `from` to index `to`.
  void copy(std::size_t from, std::size_t to);
};

/// Memory per particle, including its true displacement and excluding images [bytes].
inline constexpr double bytes_per_particle = 450;

/// Returns an upper estimate of the displacement during half the time between the pulses, per axis [m]. It is 1.25
/// times the largest displacement on a lattice of 33^3 points over the volume.
Vec3d motion_margin(FlowSetup const& flow, Vec3d volume, Vec3d center);

/// Box in which particles are placed at mid-time, and their number.
struct SeedingPlan {
  Vec3d size{};  ///< size of the box about the volume's centre: the volume enlarged by motion_margin() [m]
  std::size_t count = 0;
};
/// @param count  mean number of particles in the volume
SeedingPlan plan_seeding(ParticleSetup const& setup, double count, FlowSetup const& flow);

/// Generates randomly placed particles in a volume, with `count` of them at each pulse on average. They are placed at
/// mid-time in the volume enlarged by motion_margin() and moved by -dt/2 and +dt/2 along the flow. The number density
/// is uniform, except behind a shock, where it follows continuity. Particles that receive no light at either pulse are
/// dropped. A particle depends on the seed and its index only.
/// @param tolerance  maximum change of a final position when the step is halved [m]
/// @pre setup.volume has a value
Particles seed_particles(ParticleSetup const& setup, double count, FlowSetup const& flow,
                         LaserSheet<double> const& sheet, double tolerance);

/// Reads particles at the first pulse from a CSV file x_mm,y_mm,z_mm,diameter_um and moves them to the second pulse.
/// @throws DataError with file:line for an invalid line
Particles read_particles(ParticleSetup const& setup, FlowSetup const& flow, LaserSheet<double> const& sheet,
                         double tolerance);

/// Draws the diameters of `count` particles [m], all positive. @throws DataError for an invalid file of diameters
std::vector<double> draw_diameters(DiameterSetup const& setup, std::uint64_t seed, std::size_t count);

}  // namespace gladstone::inline light
