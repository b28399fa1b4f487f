#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include "render/optics/prescription.h"
#include "render/optics/prescription_readers/lines.h"

namespace gladstone {

/// Apertures and obscurations that a block SURF puts on its surface [m].
struct ZmxApertures {
  struct Ring {
    double least = 0, largest = 0;
  };
  std::string where;  ///< the last of their lines
  std::optional<Ring> aperture;
  double disc = 0;  ///< radius of an obscuration
  std::optional<Ring> obscured_ring;
  SurfaceOutline<double> outline;
  Vec2d centre{};  ///< of all of them
};

/// Reads an operand that limits light on a surface: circular apertures and obscurations (CLAP, FLAP, OBSC),
/// rectangular and elliptical ones (SQAP, SQOB, ELAP, ELOB), and where they are centred (OBDC). Spiders and the user's
/// own shapes are passed over with a warning.
/// @param unit of length [m]
/// @return whether the line is such an operand. @throws DataError
bool read_zmx_aperture(PrescriptionLine const& line, double unit, ZmxApertures& apertures,
                       std::vector<std::string>& warnings);

/// Puts them on the surface, whose semi-diameter has been read. An obscuration as large as the semi-diameter, which
/// then is the disc's own, leaves it no edge: light passes outside.
void put_apertures(ZmxApertures const& apertures, PrescribedSurface& surface, std::vector<std::string>& warnings);

/// What a file says besides lens and apertures.
class ZmxNotes {
 public:
  /// Notes an operand that changes how much light passes, and not where, or that is not known. @throws DataError
  void read(PrescriptionLine const& line);
  /// One warning for every kind.
  std::vector<std::string> warnings() const;

 private:
  void note(std::string const& key, std::string const& text);

  std::set<std::string> keys_;
  std::vector<std::string> notes_;
  std::vector<std::string> unknown_;  // operands
  std::string unknown_where_;
};

}  // namespace gladstone
