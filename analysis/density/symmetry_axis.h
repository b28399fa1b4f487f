#pragma once

#include "analysis/density/gradient_map.h"
#include "analysis/density/window_correlation.h"

namespace gladstone::density {

/// Direction of the axis of an axisymmetric flow in the plane of the grid.
enum class AxisDirection { vertical, horizontal };

/// Exchanges x and y, so that a horizontal axis becomes a vertical one.
GradientMap transpose_map(GradientMap const& map);

/// Position of a symmetry axis.
struct SymmetryAxis {
  double position = 0.0;  ///< x of a vertical, y of a horizontal axis [m]
  double sigma = 0.0;     ///< standard uncertainty from that of the gradient [m]; NaN: gradient without sigma
};

/// Finds the axis about which the gradient across it is odd: the centre c of symmetry maximises
///   S(c) = -sum over nodes of g(x) g(2 c - x),
/// the self-convolution of the gradient g less its mean, first in steps of half a node, then between nodes by cubic
/// interpolation. Assumes that the flow lies within the image; if only one half of it is visible, the axis must be
/// given by the user.
/// @param overlap  of the interrogation windows, for the uncertainty
/// @throws DataError  if the gradient vanishes, or the axis found is within two nodes of the border
SymmetryAxis find_symmetry_axis(GradientMap const& map, AxisDirection direction, WindowOverlap overlap = {});

}  // namespace gladstone::density
