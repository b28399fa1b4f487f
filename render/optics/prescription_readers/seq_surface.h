#pragma once

#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/optics/prescription.h"
#include "render/optics/prescription_readers/lines.h"

namespace gladstone::inline optics {

/// Surface of a CODE V file.
struct SeqSurface {
  /// Scope of a decentre.
  enum class Decentre {
    basic,    ///< this surface and all following ones
    ret,      ///< this surface only (DAR)
    bend,     ///< this surface; the frame of the following ones is rotated by the same angles once more (BEN), as by a
              ///< fold mirror
    reverse,  ///< the following surfaces, with the inverse transformation (REV)
  };
  PrescribedSurface surface;
  Decentre kind = Decentre::basic;
  Vec3d shift{};                 ///< decentre and translation along z [m]
  Vec3d tilt{};                  ///< right-handed [rad]
  std::vector<double> asphere;   ///< coefficients of r^2, r^4, ..., in the file's unit
  SurfaceOutline<double> shape;  ///< aperture by REX, REY, ELX, ELY
  Vec2d centre{};                ///< centre of all apertures (ADX, ADY) [m]

  /// Returns the coordinate breaks ahead of the surface.
  std::vector<CoordinateBreak> breaks_before() const;
  /// Returns the coordinate breaks behind the surface, which precede its thickness.
  std::vector<CoordinateBreak> breaks_behind() const;
};

/// Reads a command that refers to a surface: stop, conic constant and aspheric terms, apertures, decentres.
/// @param command   in upper case
/// @param unit      unit of length [m]
/// @param is_image  true for the image SI, of which only the coordinate frame is used
/// @return false if it is not such a command
/// @throws DataError
bool read_seq_surface(std::string const& command, PrescriptionLine const& line, double unit, bool is_image,
                      SeqSurface& seq, Warnings& warnings);

/// Stores aspheric terms and apertures in the surface. @param unit  unit of length [m]
void finish_seq_surface(SeqSurface& seq, double unit, Warnings& warnings);

}  // namespace gladstone::inline optics
