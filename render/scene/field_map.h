#pragma once

#include "render/base/image.h"
#include "render/base/vec.h"
#include "render/scene/scene.h"

namespace gladstone {

/// What Eq. 9 integrates, seen through the camera: averages along the chief ray of every lattice point of the view.
struct FieldMap {
  int spacing_px = 1;             ///< lattice point (i, j) at pixel (i, j) * spacing + (spacing - 1) / 2
  Image<double> density;          ///< path-averaged [kg/m^3]; ambient where a ray misses the field
  Image<Vec2d> density_gradient;  ///< path-averaged d rho / d(X, Y) [kg/m^4]
  Image<Vec2d> eq9_px;            ///< Eq. 9 [px]

  /// Ambient density wherever the view is, and nothing that moves.
  static FieldMap ambient(Setup const& setup, int spacing_px);
  Vec2d position_px(int column, int row) const {
    return {spacing_px * (column + 0.5) - 0.5, spacing_px * (row + 0.5) - 0.5};
  }
};

/// @param spacing_px lattice constant [px]
FieldMap map_field(Scene const& scene, int spacing_px);

/// Strain of a displacement over the view (g = -d Delta / dx in the image).
struct StrainMap {
  int spacing_px = 0;
  Image<double> caustic;        ///< largest eigenvalue of the symmetric part of grad Delta; 1 or more: rays cross
  Image<double> strain;         ///< largest magnitude of an eigenvalue
  double caustic_fraction = 0;  ///< share of the view at 1 or more
  double largest_px = 0;        ///< displacement anywhere on the lattice
};

/// Strain of displacements on a lattice [px], by central differences, one-sided at the edges. @pre at least 2 x 2 nodes
StrainMap strain_of(Image<Vec2d> const& displacement, int spacing_px);

/// Cone-averaged Eq. 9 on a lattice of virtual points, and its finite differences. The rays of a point's cone are taken
/// for the chief rays of its neighbours that cross the medium's mid-plane at the same places, so that cones share them.
StrainMap map_strain(Scene const& scene);

}  // namespace gladstone
