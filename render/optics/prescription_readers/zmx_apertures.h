#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/optics/prescription.h"
#include "render/optics/prescription_readers/lines.h"

namespace gladstone::inline optics {

/// Apertures and obscurations of a SURF block [m].
struct ZmxApertures {
  struct Ring {
    double least = 0, largest = 0;
  };
  std::string where;  ///< location of the last aperture line
  std::optional<Ring> aperture;
  double disc = 0;  ///< radius of a circular obscuration
  std::optional<Ring> obscured_ring;
  SurfaceOutline<double> outline;
  Vec2d centre{};  ///< centre of all apertures and obscurations
};

/// Reads an operand that limits the light on a surface: circular apertures and obscurations (CLAP, FLAP, OBSC),
/// rectangular and elliptical ones (SQAP, SQOB, ELAP, ELOB), and their centre (OBDC). Spiders and user-defined shapes
/// are ignored with a warning.
/// @param unit  unit of length [m]
/// @return false if the line is not such an operand
/// @throws DataError
bool read_zmx_aperture(PrescriptionLine const& line, double unit, ZmxApertures& apertures, Warnings& warnings);

/// Stores the apertures in the surface, whose semi-diameter has been read before. If an obscuration is as large as the
/// semi-diameter, the latter is taken as the size of the obscuration only, and light passes outside.
void put_apertures(ZmxApertures const& apertures, PrescribedSurface& surface, Warnings& warnings);

/// Collects warnings about operands of a file that are not used.
class ZmxNotes {
 public:
  /// Reads an operand, and adds a note if it is unknown or changes the amount of light only. @throws DataError
  void read(PrescriptionLine const& line);
  /// Returns the warnings, one for each kind.
  Warnings warnings() const;

 private:
  void note(std::string const& key, std::string const& where, std::string const& text);

  std::set<std::string> keys_;
  Warnings notes_;
  std::vector<std::string> unknown_;  // unknown operands
  std::string unknown_where_;
};

}  // namespace gladstone::inline optics
