#pragma once

#include "render/light/flow.h"
#include "render/light/laser_sheet.h"
#include "render/light/particle_setup.h"

/// Particles in a cube, their flow and their illumination, for tests.
namespace gladstone {

inline FlowSetup uniform_flow(Vec3d velocity, double dt = 1e-5) {
  FlowSetup flow;
  flow.flow.uniform = velocity;
  flow.dt = dt;
  return flow;
}

inline ParticleSetup cube_of_particles(double side) {
  ParticleSetup setup;
  setup.volume = Vec3d{side, side, side};
  return setup;
}

/// A sheet that illuminates the whole volume.
inline LaserSheet<double> wide_sheet() {
  LaserSetup laser;
  laser.profile = SheetProfile::top_hat;
  laser.thickness = laser.height = 1;
  return laser_sheet(laser);
}

}  // namespace gladstone
