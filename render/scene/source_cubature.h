#pragma once

#include <vector>

#include "render/base/vec.h"
#include "render/light/sources.h"

namespace gladstone::inline scene {

/// Cubature rule over a source, a unit disc or square, that integrates the PSF over the source's area with an error far
/// below a grey level.
struct SourceCubature {
  std::vector<Vec2d> points;    ///< points in units of the source's half size
  std::vector<double> weights;  ///< weights of sum 1

  /// Returns a rule for the uniform unit disc: Gauss-Legendre in r^2 times equally spaced angles, rotated by half a
  /// step in every other ring.
  /// @param radial  number of rings
  /// @param innermost,outermost  number of points on a ring of radius 0 and 1; linear in between
  static SourceCubature disc(int radial, int innermost, int outermost);
  /// Returns Radon's seven-point rule, exact up to degree 5 over the unit disc (Radon 1948; Stroud 1971, S2: 5-1).
  static SourceCubature radon();
  /// Returns a Gauss-Legendre rule for the square [-1, 1]^2 with `side` points along each axis.
  static SourceCubature square(int side);
  /// Returns a rule for a source's image; a point source has one node. For a disc and a PSF wider than a twentieth of
  /// it, the error is 1e-5 of the peak; for a dot of Table 1 (Rajendran et al. 2019), 4e-7.
  /// @param half_size_px  half size of the source's geometric image [px]
  /// @param spot_px  standard deviation of the PSF [px]; a smaller one requires more points
  static SourceCubature make(SourceShape shape, double half_size_px, double spot_px);
};

}  // namespace gladstone::inline scene
