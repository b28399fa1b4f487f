#pragma once

#include "render/base/units.h"
#include "render/optics/field_analysis.h"
#include "render/optics/prescription.h"
#include "tests/fuzz/input.h"

namespace gladstone::fuzz {

/// Gives a lens prescription to its reader and judges the lens as `gladstone info lens` does, by few rays.
inline void read_lens(std::string_view input, std::string const& name) {
  std::string const path = file_of(input, name);
  read(input, [&] {
    Prescription prescription = read_prescription(path);
    double const wavelength = prescription.primary_wavelength > 0 ? prescription.primary_wavelength : spectral_line::d;
    Lens const lens = build_lens(std::move(prescription), GlassCatalogue::shipped(), wavelength);
    analyse_field(lens, paraxial_lens(lens), 16);
  });
}

}  // namespace gladstone::fuzz
