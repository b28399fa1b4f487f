#pragma once

#include "render/scene/scene.h"

namespace gladstone::test {

/// Returns a PIV setup with 0.05 particles per pixel in a sheet of 1 mm, imaged by a lens of 105 mm at f/16 from 750 mm
/// to pixels of 5 um: particle images 3.3 px wide (e^-2), 12 bits, no medium. The sheet is slightly larger than the
/// field of view.
inline Setup pair_setup(ParticleScattering scattering, int columns, int rows) {
  Setup setup;
  setup.camera.columns = columns;
  setup.camera.rows = rows;
  setup.camera.pixel_pitch = 5e-6;
  setup.camera.bit_depth = 12;
  setup.lens.f_number = 16;
  setup.z_d = 0;
  setup.medium.field = {};
  PivSetup piv;
  piv.particles.scattering = scattering;
  piv.particles.count = ParticleCount::per_pixel;
  piv.particles.amount = 0.05;
  piv.particles.volume = Vec3d{34e-3 * columns / 1024, 34e-3 * rows / 1024, 1e-3};
  setup.piv = piv;
  return setup;
}

}  // namespace gladstone::test
