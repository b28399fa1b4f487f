#pragma once

#include <string>
#include <vector>

#include "render/optics/prescription.h"
#include "render/optics/prescription_readers/lines.h"

namespace gladstone::inline optics {

/// Properties of the whole lens in a CODE V file: units, aperture, wavelengths, and how curvatures are given.
struct SeqSystem {
  double unit = 1e-3;       ///< unit of length [m]
  double pupil = 0;         ///< diameter of the entrance pupil [unit]
  bool radii = false;       ///< surfaces have radii (RDM), not curvatures
  bool radii_said = false;  ///< the file states whether surfaces have radii or curvatures
  std::vector<ListedWavelength> wavelengths;
  int reference = 0;                  ///< number of the reference wavelength, from 1; 0: not set
  std::string private_glasses_where;  ///< line of PRV while its block is read
  std::string paraxial_image_where;   ///< line of PIM

  /// Returns the primary wavelength: that of REF, or the middle one without REF, as in CODE V; null if none is listed.
  ListedWavelength const* primary_wavelength() const;
};

/// Reads a command that applies to the whole lens: aperture, wavelengths, fields, units, title.
/// @param command  in upper case
/// @param result   receives aperture, title, field angles and warnings
/// @return false if it is not such a command
/// @throws DataError
bool read_seq_system(std::string const& command, PrescriptionLine const& line, SeqSystem& system, Prescription& result);

}  // namespace gladstone::inline optics
