#pragma once

#include <string>
#include <vector>

#include "render/optics/prescription.h"
#include "render/optics/prescription_readers/lines.h"

namespace gladstone::inline optics {

/// Properties of the whole lens in a .zmx file, from the lines ahead of its first surface: units, wavelengths, fields.
struct ZmxSystem {
  double unit = 1e-3;  ///< unit of length [m]
  std::vector<ListedWavelength> wavelengths;
  int primary = 1;                    ///< number of the primary wavelength, from 1
  std::vector<double> fields;         ///< field angles in the y-z plane [rad]
  std::string heights_at, across_at;  ///< places in the file of field heights, and of fields outside the y-z plane, for
                                      ///< warnings
};

/// Reads a line ahead of the first surface; lines of other operands have no effect.
/// @param result  receives aperture, title and catalogues
/// @throws DataError
void read_zmx_system(PrescriptionLine const& line, ZmxSystem& system, Prescription& result);

/// Uses field angles in the y-z plane; other fields cause a warning.
void take_zmx_fields(ZmxSystem const& system, Prescription& result);

}  // namespace gladstone::inline optics
