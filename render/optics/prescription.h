#pragma once

#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "render/base/vec.h"
#include "render/optics/glass.h"
#include "render/optics/surface_outline.h"

namespace gladstone {

/// What stands behind a surface, as a prescription says it.
struct PrescribedMedium {
  struct Air {};
  struct Mirror {};  ///< the surface reflects
  struct Index {
    double n;  ///< at every wavelength [1]
  };
  struct Described {
    double nd, vd;
  };
  struct Named {
    std::string glass;                                  ///< in a catalogue
    std::optional<Described> otherwise = std::nullopt;  ///< of a glass that no catalogue has
  };
  struct Private {
    Glass glass;  ///< that the prescription defines itself
  };
  std::variant<Air, Mirror, Named, Index, Described, Private> is = Air{};

  bool is_mirror() const { return std::holds_alternative<Mirror>(is); }
  bool is_air() const { return std::holds_alternative<Air>(is); }
};

/// How the frame moves ahead of a surface: by a decentre along x and y and turns about x, y, z, and then along its z.
struct CoordinateBreak {
  Vec2d decentre{};         ///< [m]
  Vec3d tilt{};             ///< right-handed, about x, then the turned y, then the turned z [rad]
  bool tilt_first = false;  ///< turns about z, y, x, and decentres after them: what undoes a break of opposite signs
  double advance = 0;       ///< along the turned axis [m]
};

/// One surface of a prescription.
struct PrescribedSurface {
  enum class Shape {
    conic,         ///< of revolution, and the polynomial that is added to it
    cylinder,      ///< curved along x alone
    tilted_plane,  ///< by `slope`, while the next surface stands in an untilted frame
    ideal_lens,    ///< a thin lens of `focal_length`, without aberration
  };
  /// Polynomial in r / scale that is added to the conic: see RadialAsphere.
  struct RadialTerms {
    double scale = 1;  ///< [m]
    bool even_powers = true;
    std::vector<double> a;  ///< [m]
  };
  std::string where;  ///< file:line, for messages
  Shape shape = Shape::conic;
  double curvature = 0;         ///< [1/m]
  double conic = 0;             ///< [1]
  std::vector<double> asphere;  ///< of r^2, r^4, ... [m^-1, m^-3, ...]
  RadialTerms radial;           ///< instead of `asphere`, if there are any
  Vec2d slope{};                ///< of a tilted plane [1]
  double focal_length = 0;      ///< of an ideal lens, in air [m]
  double thickness = 0;         ///< along the axis to the next surface; negative behind a mirror [m]
  PrescribedMedium after;
  double semi_diameter = std::numeric_limits<double>::infinity();  ///< [m]
  bool semi_diameter_is_an_edge = true;  ///< false: for drawings, as design programs fill it in; light passes beyond
  bool has_aperture = false;             ///< an aperture of that semi-diameter stands on it, which bounds a stop too
  double obscured = 0;                   ///< radius within which no light passes [m]
  bool obscured_without_end = false;     ///< by an aperture that begins at that radius and has no outer one
  SurfaceOutline<double> outline;        ///< an aperture or obscuration that is no circle about the axis
  bool stop = false;
  std::vector<CoordinateBreak> before;  ///< breaks in the frame ahead of it
};

/// How far the breaks ahead of a surface move it along the axis [m].
double advance(PrescribedSurface const& surface);

/// What sets the width of the stop.
struct PrescribedAperture {
  enum class Kind {
    stop,              ///< the stop surface's own semi-diameter
    entrance_pupil,    ///< diameter of the entrance pupil [m]
    f_number,          ///< effective focal length over that diameter [1]
    object_na,         ///< numerical aperture on the object's side [1]
    working_f_number,  ///< one over twice the slope of the axial cone's rim towards the image [1]
  };
  Kind kind = Kind::stop;
  double value = 0;
};

/// A lens as its file describes it, in SI. The frame's origin is the vertex of the first surface, light comes from -z.
/// Breaks ahead of that surface move it across the axis and turn it; what they advance adds to the object's distance.
struct Prescription {
  std::string file;
  std::string title;
  std::string source;  ///< where it was published
  std::vector<PrescribedSurface> surfaces;
  double object_distance = std::numeric_limits<double>::infinity();  ///< to the first surface [m]
  PrescribedMedium object_medium;                                    ///< ahead of the first surface
  std::vector<std::string> catalogues;                               ///< of glass that the file names, in their order
  PrescribedAperture aperture;
  double primary_wavelength = 0;      ///< [m]; 0: the file says none
  bool ends_at_image = false;         ///< the last thickness leads to the image, one of 0 too
  std::vector<double> field_angles;   ///< of the object at infinity, against the axis, in the y-z plane [rad]
  std::vector<std::string> warnings;  ///< of what a file says that is not traced
};

/// Ends a lens at an image whose frame is broken: a plane of reference takes the breaks, so that the last surface's
/// frame is the image's; what the last break advances becomes that plane's thickness. Nothing where there are no
/// breaks.
/// @param where the image stands in the file
void break_before_image(Prescription& lens, std::vector<CoordinateBreak> breaks, std::string const& where);

/// Marks the first surface as the stop of a lens whose file names none, as design programs do, and warns of it.
void assume_stop(Prescription& lens);

/// Reads a prescription: one row per format in prescription.cpp (.toml, Zemax .zmx, CODE V .seq), and checks that it
/// describes a lens: a surface or more, one stop, finite numbers. Warns of surfaces whose edges overlap, or which do
/// not reach their semi-diameter.
/// @throws SetupError or DataError with file and line
Prescription read_prescription(std::string const& path);

/// The checks of read_prescription, for a reader's result.
/// @return warnings @throws DataError
std::vector<std::string> check_prescription(Prescription const& prescription);

}  // namespace gladstone
