#pragma once

#include "render/scene/setup.h"

namespace gladstone {

/// Returns a PIV setup with the lens of Table 1 at f/8, 750 mm in front of a uniform light sheet, and with white
/// spheres of 1 um.
/// @param sheet,depth  thickness of the light sheet and of the volume with particles, along the line of sight [m]
inline Setup piv_setup(double sheet, double depth) {
  constexpr double mm = 1e-3;
  Setup setup;
  setup.camera.columns = setup.camera.rows = 128;
  setup.lens.f_number = 8;
  setup.z_d = 0;
  setup.medium.field = {};
  PivSetup piv;
  piv.laser.profile = SheetProfile::top_hat;
  piv.laser.thickness = sheet;
  piv.particles.scattering = ParticleScattering::lambert;
  piv.particles.amount = 50;
  piv.particles.volume = Vec3d{8 * mm, 8 * mm, depth};
  setup.piv = piv;
  return setup;
}

}  // namespace gladstone
