#pragma once

#include <vector>

#include "render/base/vec.h"
#include "render/light/sources.h"

namespace gladstone {

/// Points of a unit disc (or square) with weights that integrate what a spot makes of a source to far below a grey
/// level.
struct SourceCubature {
  std::vector<Vec2d> points;    ///< offsets in units of the source's half size
  std::vector<double> weights;  ///< sum 1

  /// Uniform over the unit disc: Gauss-Legendre in r^2 times equal angles, turned by half a step from ring to ring.
  /// @param innermost,outermost points on a ring of radius zero and one; between them in proportion
  static SourceCubature disc(int radial, int innermost, int outermost);
  /// Seven points, exact up to degree 5 over the unit disc (Radon 1948; Stroud 1971, S2: 5-1).
  static SourceCubature radon();
  /// Uniform over the square from -1 to 1: Gauss-Legendre with `side` points in both directions.
  static SourceCubature square(int side);
  /// Disc as above; a spot that is wider than a twentieth of the disc is integrated to 1e-5 of the peak, a Table 1 dot
  /// to 4e-7. Square: Gauss-Legendre in both directions. A point: itself.
  /// @param half_size_px of the source's image; the finer the spot beside it, the more points
  static SourceCubature make(SourceShape shape, double half_size_px, double spot_px);
};

}  // namespace gladstone
