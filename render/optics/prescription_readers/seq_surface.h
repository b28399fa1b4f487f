#pragma once

#include <string>
#include <vector>

#include "render/optics/prescription.h"
#include "render/optics/prescription_readers/lines.h"

namespace gladstone {

/// A surface of a CODE V file.
struct SeqSurface {
  /// What a decentre moves.
  enum class Decentre {
    basic,    ///< this surface and all that follow
    ret,      ///< this one alone (DAR)
    bend,     ///< this one; what follows is tilted once more (BEN), as a mirror turns the light
    reverse,  ///< what follows, back (REV)
  };
  PrescribedSurface surface;
  Decentre kind = Decentre::basic;
  Vec3d shift{};                 ///< [m]
  Vec3d tilt{};                  ///< right-handed [rad]
  std::vector<double> asphere;   ///< of r^2, r^4, ..., in the file's unit
  SurfaceOutline<double> shape;  ///< REX, REY, ELX, ELY
  Vec2d centre{};                ///< of all apertures (ADX, ADY) [m]

  /// Breaks in the frame ahead of the surface.
  std::vector<CoordinateBreak> breaks_before() const;
  /// Breaks behind it, ahead of its thickness.
  std::vector<CoordinateBreak> breaks_behind() const;
};

/// Reads a command that belongs to a surface: stop, conic and aspheric terms, apertures, decentres.
/// @param command in capitals @param unit of length [m] @param is_image the image SI, of which the frame counts
/// @return whether it is such a command. @throws DataError
bool read_seq_surface(std::string const& command, PrescriptionLine const& line, double unit, bool is_image,
                      SeqSurface& seq, std::vector<std::string>& warnings);

/// Puts aspheric terms and apertures on the surface. @param unit of length [m]
void finish_seq_surface(SeqSurface& seq, double unit, std::vector<std::string>& warnings);

}  // namespace gladstone
