#pragma once

#include <limits>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "render/base/vec.h"
#include "render/base/warning.h"
#include "render/optics/glass.h"
#include "render/optics/surface_outline.h"

namespace gladstone::inline optics {

/// Medium behind a surface, as specified by a prescription.
struct PrescribedMedium {
  struct Air {};
  struct Mirror {};  ///< reflecting surface
  struct Index {
    double n;  ///< index at all wavelengths [1]
  };
  struct Described {
    double nd, vd;
  };
  struct Named {
    std::string glass;                                  ///< name in a glass catalogue
    std::optional<Described> otherwise = std::nullopt;  ///< nd and Vd to use if no catalogue has the glass
  };
  struct Private {
    Glass glass;  ///< glass defined in the prescription itself
  };
  std::variant<Air, Mirror, Named, Index, Described, Private> is = Air{};
  std::string where{};  ///< location of the medium in the file; empty: that of its surface

  bool is_mirror() const { return std::holds_alternative<Mirror>(is); }
  bool is_air() const { return std::holds_alternative<Air>(is); }
};

/// Transformation of the coordinate frame ahead of a surface: decentre along x and y, rotation about x, y, z, then
/// translation along z.
struct CoordinateBreak {
  Vec2d decentre{};         ///< [m]
  Vec3d tilt{};             ///< right-handed rotations about x, the rotated y, then the rotated z [rad]
  bool tilt_first = false;  ///< true: inverse order, i.e. rotations about z, y, x, then decentre
  double advance = 0;       ///< translation along the rotated z axis [m]
};

/// Surface of a prescription.
struct PrescribedSurface {
  enum class Shape {
    conic,         ///< conic of revolution, plus a polynomial
    cylinder,      ///< cylinder curved along x only
    tilted_plane,  ///< plane tilted by `slope`; the frame of the next surface is not tilted
    ideal_lens,    ///< ideal thin lens of `focal_length`
  };
  /// Polynomial in r / scale added to the conic, see RadialAsphere.
  struct RadialTerms {
    double scale = 1;  ///< radius by which r is normalised [m]
    bool even_powers = true;
    std::vector<double> a;  ///< sag of each term at r = scale [m]
  };
  std::string where;  ///< file:line, for messages
  Shape shape = Shape::conic;
  double curvature = 0;         ///< [1/m]
  double conic = 0;             ///< [1]
  std::vector<double> asphere;  ///< coefficients of r^2, r^4, ... [m^-1, m^-3, ...]
  RadialTerms radial;           ///< replaces `asphere` if it has terms
  Vec2d slope{};                ///< slope of a tilted plane [1]
  double focal_length = 0;      ///< focal length of an ideal lens in air [m]
  double thickness = 0;         ///< distance along the axis to the next surface; negative behind a mirror [m]
  PrescribedMedium after;
  double semi_diameter = std::numeric_limits<double>::infinity();  ///< [m]
  bool semi_diameter_vignettes = true;  ///< false: for drawings, from a design program; does not vignette
  bool has_aperture = false;  ///< true: the surface has an aperture of this semi-diameter, which also limits a stop
  double obscured = 0;        ///< radius of a central obscuration [m]
  bool obscured_without_end =
      false;  ///< true: `obscured` is the inner radius of an aperture, beyond which the surface is opaque
  SurfaceOutline<double> outline;  ///< aperture or obscuration that is not a circle about the axis
  bool stop = false;
  std::vector<CoordinateBreak> before;  ///< coordinate breaks ahead of the surface
};

/// Returns the sum of the translations along z of the breaks ahead of a surface [m].
double advance(PrescribedSurface const& surface);

/// Specification of the aperture, which determines the radius of the stop.
struct PrescribedAperture {
  enum class Kind {
    stop,              ///< semi-diameter of the stop surface
    entrance_pupil,    ///< diameter of the entrance pupil [m]
    f_number,          ///< effective focal length over diameter of the entrance pupil [1]
    object_na,         ///< object-side numerical aperture [1]
    working_f_number,  ///< 1 / (2 slope of the axial cone's marginal ray on the image side) [1]
  };
  Kind kind = Kind::stop;
  double value = 0;
  std::string where{};  ///< location in the file; empty: the file does not set the aperture
};

/// Lens as described by its file, in SI. The origin of the frame is the vertex of the first surface, and light comes
/// from -z. Coordinate breaks ahead of that surface move it across the axis and rotate it; their translation along z is
/// added to the object distance.
struct Prescription {
  std::string file;
  std::string title;
  std::string source;  ///< publication of the design
  std::vector<PrescribedSurface> surfaces;
  double object_distance = std::numeric_limits<double>::infinity();  ///< distance from the object to the first surface
                                                                     ///< [m]
  PrescribedMedium object_medium;                                    ///< medium ahead of the first surface
  std::vector<std::string> catalogues;  ///< glass catalogues named by the file, in its order
  PrescribedAperture aperture;
  double primary_wavelength = 0;     ///< primary wavelength [m]; 0: not given
  double defocus = 0;                ///< from the paraxial image to the image, if the last thickness is 0 [m]
  bool ends_at_image = false;        ///< the last thickness is the distance to the image, even if it is 0
  std::vector<double> field_angles;  ///< field angles in the y-z plane, for an object at infinity [rad]
  Warnings warnings;                 ///< features of the file that are not traced
};

/// Adds the coordinate breaks ahead of the image to a lens. A reference plane is appended with these breaks, so that
/// the frame of the last surface is that of the image; the translation of the last break becomes the plane's thickness.
/// Without breaks, the lens is not changed.
/// @param where  location of the image in the file
void break_before_image(Prescription& lens, std::vector<CoordinateBreak> breaks, std::string const& where);

/// Makes the first surface the stop if the file does not define one, as design programs do, and adds a warning.
void assume_stop(Prescription& lens);

/// Uses the semi-diameter of the stop if the file sets no aperture or an aperture of 0, and adds a warning.
/// @param commands  commands of the file format that set the aperture
/// @pre one surface is the stop
void assume_aperture(Prescription& lens, char const* commands);

/// Reads a prescription from a .toml, Zemax .zmx or CODE V .seq file, and checks it with check_prescription(). To add a
/// format, add a row in prescription.cpp.
/// @throws SetupError or DataError with file and line
Prescription read_prescription(std::string const& path);

/// Checks that a prescription describes a lens: at least one surface, exactly one stop, finite numbers. Warns of
/// surfaces that overlap near their edges or do not extend to their semi-diameter.
/// @return warnings
/// @throws DataError
Warnings check_prescription(Prescription const& prescription);

}  // namespace gladstone::inline optics
