#pragma once

#include "render/base/image.h"
#include "render/base/vec.h"
#include "render/scene/scene.h"

namespace gladstone::inline scene {

/// Integrals of small-angle theory (Eq. 9) over a regular lattice of the image: averages along the chief ray of every
/// lattice point.
struct FieldMap {
  int spacing_px = 1;             ///< lattice constant; point (i, j) is at pixel (i, j) * spacing + (spacing - 1) / 2
  Image<double> density;          ///< path-averaged density [kg/m^3]; ambient density where the ray misses the field
  Image<Vec2d> density_gradient;  ///< path-averaged gradient d rho / d(X, Y) [kg/m^4]
  Image<Vec2d> eq9_px;            ///< displacement by Eq. 9 of Rajendran et al. (2019) [px]

  /// Returns a map of ambient density and zero displacement over the whole view.
  static FieldMap ambient(Setup const& setup, int spacing_px);
  Vec2d position_px(int column, int row) const {
    return {spacing_px * (column + 0.5) - 0.5, spacing_px * (row + 0.5) - 0.5};
  }
};

/// Computes the map of a set-up with an ideal thin lens on the Z axis; map_field_by_rays() treats any camera.
/// @param longest_step  maximum integration step [m]
/// @param spacing_px  lattice constant [px]
FieldMap map_field(Scene const& scene, double longest_step, int spacing_px);

/// Strain of a displacement field in the image, g = -d Delta / dx.
struct StrainMap {
  int spacing_px = 0;
  Image<double> caustic;        ///< largest eigenvalue of the symmetric part of grad Delta; >= 1: rays cross (caustic)
  Image<double> strain;         ///< largest absolute eigenvalue of the symmetric part of grad Delta
  double caustic_fraction = 0;  ///< fraction of the lattice where `caustic` >= 1
  double largest_px = 0;        ///< largest displacement on the lattice [px]
};

/// Computes the strain of displacements on a lattice by central differences, one-sided at the edges.
/// @param displacement  displacements [px]
/// @pre at least 2 x 2 lattice points
StrainMap compute_strain(Image<Vec2d> const& displacement, int spacing_px);

/// Computes the strain of aperture-averaged theory (Eq. 9 averaged over the light cone) on a lattice of virtual dots.
/// The rays of a dot's cone are approximated by the chief rays of neighbouring lattice points that cross the medium's
/// mid-plane at the same positions, so that all cones share the same rays.
StrainMap map_strain(Scene const& scene);

}  // namespace gladstone::inline scene
