#pragma once

#include <limits>
#include <string>

#include "render/base/pose.h"
#include "render/base/vec.h"
#include "render/optics/element_side.h"
#include "render/optics/lens_surface.h"
#include "render/setup/setup_table.h"

namespace gladstone::inline optics {

/// Common part of the optical elements that are a piece of glass with two plane faces, in SI.
struct GlassPlate {
  template <class T>
  using OwnSurfaces = SurfaceTypes<>;

  ElementSide side = ElementSide::camera;
  std::string glass;
  double index = 1;       ///< index of the glass at the setup's wavelength, relative to its surroundings [1]
  double absorption = 0;  ///< absorption coefficient of the glass; 0 unless lens.transmittance includes it [1/m]
  double thickness = 0;   ///< thickness at the centre [m]
  Vec3d position{};       ///< position of the plate's centre in the frame of target or camera, see `side` [m]
  Vec2d tilt{};           ///< right-handed rotations about x, then about the rotated y [rad]

  /// Pose of the mid-plane in the frame of its side; light propagates along its z axis.
  Pose<double> pose() const { return Pose<double>{position}.turned({tilt.x, tilt.y, 0}); }
  /// Apparent displacement of objects towards the observer at normal incidence, t (1 - 1/n) [m].
  double shift() const { return thickness * (1 - 1 / index); }

 protected:
  using Face = ShapedSurface<double, Quadric<double>>;

  /// Returns the face by which light enters. @param pose  pose of the face in the world
  Face entry_face(Pose<double> const& pose, bool fresnel) const {
    Face face;
    face.semi_diameter = std::numeric_limits<double>::infinity();
    face.pose = pose;
    face.n_after = index;
    face.fresnel = fresnel;
    return face;
  }
  Face exit_face(Pose<double> const& pose, bool fresnel) const {
    Face face = entry_face(pose, fresnel);
    face.n_before = index;
    face.n_after = 1;
    face.absorption = absorption;
    return face;
  }

  /// Reads the keys of a plate. Index and absorption are set later, when the wavelength is known.
  static GlassPlate read_keys(SetupTable& table);
};

}  // namespace gladstone::inline optics
