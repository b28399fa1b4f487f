#pragma once

#include "analysis/density/gradient_map.h"
#include "analysis/density/window_correlation.h"

namespace gladstone::inline density {

/// Direction of the axis of an axisymmetric flow in the plane of the grid.
enum class AxisDirection { vertical, horizontal };

/// Exchanges x and y, so that a horizontal axis becomes a vertical one.
GradientMap transpose_map(GradientMap const& map);

/// Position of a symmetry axis.
struct SymmetryAxis {
  double position = 0.0;  ///< x of a vertical, y of a horizontal axis [m]
  /// Standard uncertainty of the position, propagated from the gradient [m]; NaN: gradient without sigma.
  double sigma = 0.0;
};

/// Finds the axis about which the gradient across it is odd: the centre c of symmetry maximises
///   S(c) = -sum over nodes of g(x) g(2 c - x),
/// the self-convolution of the gradient g minus its mean. The maximum is searched first in steps of half a node, then
/// between nodes by cubic interpolation. Assumes that the flow lies within the image; if only one half of the flow is
/// visible, the user must give the axis.
/// @param overlap  overlap of the interrogation windows, for the uncertainty
/// @throws DataError  if the gradient vanishes, or the axis found is within two nodes of the border
SymmetryAxis find_symmetry_axis(GradientMap const& map, AxisDirection direction, WindowOverlap overlap = {});

}  // namespace gladstone::inline density
