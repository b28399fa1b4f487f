#pragma once

#include <memory>
#include <string>

#include "render/optics/paraxial.h"
#include "tests/scene/small_scenes.h"

namespace gladstone {

/// Returns Table 1 with a lens of data/lenses/, positioned by its front principal plane.
inline Setup real_lens_setup(std::string const& lens, int pixels, double f_number) {
  Setup setup = table1_setup(pixels);
  LensOptions options;
  options.f_number = f_number;
  setup.lens.prescription = std::make_shared<Lens const>(
      build_lens(read_prescription(std::string(GLADSTONE_DATA_DIR) + "/lenses/" + lens + ".toml"),
                 GlassCatalogue::shipped(), setup.medium.wavelength, options));
  setup.lens.focal_length = paraxial_lens(*setup.lens.prescription).effective_focal_length;
  setup.lens.f_number = f_number;
  return setup;
}

inline Setup double_gauss_setup(int pixels, double f_number = 11) {
  return real_lens_setup("double_gauss", pixels, f_number);
}

}  // namespace gladstone
