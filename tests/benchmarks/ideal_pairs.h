#pragma once

#include "render/scene/scene.h"

namespace gladstone::bench {

/// Square images with 0.05 particles per pixel, particle images 3.3 px wide (e^-2), no medium.
inline Setup pair_setup(ParticleScattering scattering, int pixels) {
  Setup setup;
  setup.camera.columns = setup.camera.rows = pixels;
  setup.camera.pixel_pitch = 5e-6;
  setup.lens.f_number = 16;
  setup.z_d = 0;
  setup.medium.field = {};
  PivSetup piv;
  piv.particles.scattering = scattering;
  piv.particles.count = ParticleCount::per_pixel;
  piv.particles.amount = 0.05;
  piv.particles.volume = Vec3d{34e-3 * pixels / 1024, 34e-3 * pixels / 1024, 1e-3};
  setup.piv = piv;
  return setup;
}

}  // namespace gladstone::bench
