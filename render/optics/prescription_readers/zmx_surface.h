#pragma once

#include <map>
#include <string>
#include <vector>

#include "render/base/warning.h"
#include "render/optics/prescription.h"
#include "render/optics/prescription_readers/lines.h"
#include "render/optics/prescription_readers/zmx_apertures.h"

namespace gladstone::inline optics {

/// SURF block of a .zmx file.
struct ZmxSurface {
  std::string label;  ///< number in the file, for messages; other programs also write 3.5 or 5AS
  PrescribedSurface surface;
  ZmxApertures apertures;
  std::string type = "STANDARD", type_where;
  bool has_glass = false, has_distance = false;
  std::map<int, double> parameters, extra_data;  ///< values of PARM and XDAT, in the file's unit
  std::string extra_where;                       ///< location of the first XDAT that is not 0
  std::string excess_where;                      ///< location of the first PARM that is not 0 and not one of 1 to 8

  double parameter(int i) const;
};

/// Reads a line of the block. @param unit  unit of length [m] @throws DataError
void read_zmx_surface(PrescriptionLine const& line, double unit, ZmxSurface& zmx, Warnings& warnings);

/// Converts a block to a surface according to its type: STANDARD, EVENASPH, ODDASPHE, XASPHERE, XOSPHERE, PARAXIAL,
/// TILTSURF. EVENASPH and ODDASPHE have the eight terms of Zemax's manual; other parameters are ignored with a warning.
/// @throws DataError for any other type
PrescribedSurface shaped_surface(ZmxSurface const& zmx, double unit, Warnings& warnings);

/// Converts a block of type COORDBRK to a coordinate break. @throws DataError if its thickness is infinite
CoordinateBreak break_of(ZmxSurface const& zmx, double unit);

}  // namespace gladstone::inline optics
