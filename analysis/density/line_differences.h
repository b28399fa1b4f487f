#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "analysis/density/gradient_map.h"

namespace gladstone::density {

/// Quadrature rule for the density difference between neighbouring nodes.
enum class EdgeRule {
  /// (g0 + g1)/2: Southwell, J. Opt. Soc. Am. 70 (1980) 998; error h^3 g''/12 per edge.
  trapezoid,
  /// Integral of the cubic through four nodes, (-g-1 + 13 g0 + 13 g1 - g2)/24; error 11 h^5 g''''/720 per edge. Next
  /// to one invalid node the parabola through three, (5 g0 + 8 g1 - g2)/12; between two, the trapezoid.
  four_point
};

enum class Axis { x, y };

/// One equation of the integration: density[to] - density[from] = sum over k of factor[k] gradient[node[k]].axis.
struct LineDifference {
  std::size_t from = 0, to = 0;  ///< neighbouring nodes, `to` at the larger coordinate
  Axis axis = Axis::x;
  std::size_t terms = 0;  ///< number of gradients, 2 to 4
  std::array<std::size_t, 4> node{};
  std::array<double, 4> factor{};  ///< [m]
  int cells = 0;                   ///< number of grid cells with four valid nodes on both sides of the edge, 0 to 2
};

/// Sets up the difference equations of all pairs of neighbouring valid nodes.
std::vector<LineDifference> make_line_differences(GradientMap const& map, EdgeRule rule);

/// Variance of the right-hand side of an equation for uncorrelated vectors, sum of (factor sigma)^2.
/// @param sigma  of the gradient [grid.size()]; empty: 1
double compute_variance(LineDifference const& difference, std::vector<Vec2d> const& sigma);

}  // namespace gladstone::density
