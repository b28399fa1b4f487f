#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "analysis/density/gradient_map.h"

namespace gladstone::inline density {

/// Quadrature rule for the density difference between neighbouring nodes.
enum class EdgeRule {
  /// (g0 + g1)/2: Southwell, J. Opt. Soc. Am. 70 (1980) 998; error h^3 g''/12 per edge.
  trapezoid,
  /// Integral of the cubic through four nodes, (-g-1 + 13 g0 + 13 g1 - g2)/24; error 11 h^5 g''''/720 per edge. Next to
  /// one invalid node, the parabola through three nodes is integrated, (5 g0 + 8 g1 - g2)/12; between two invalid
  /// nodes, the trapezoid is used.
  four_point
};

enum class LineAxis { x, y };

/// One equation of the integration: density[to] - density[from] = sum over k of factor[k] gradient[node[k]].axis.
struct LineDifference {
  std::size_t from = 0, to = 0;  ///< indices of neighbouring nodes, `to` being that with the larger coordinate
  LineAxis axis = LineAxis::x;
  std::size_t terms = 0;  ///< number of gradients, 2 to 4
  std::array<std::size_t, 4> node{};
  std::array<double, 4> factor{};  ///< quadrature weights of the gradients [m]
  /// Number of the two grid cells adjacent to the edge whose four nodes are valid, 0 to 2.
  int cells = 0;
};

/// Sets up the difference equations of all pairs of neighbouring valid nodes.
std::vector<LineDifference> make_line_differences(GradientMap const& map, EdgeRule rule);

/// Computes the variance of the right-hand side of an equation for uncorrelated vectors, sum of (factor sigma)^2.
/// @param sigma  standard uncertainty of the gradient [grid.size()]; empty: 1 for all nodes
double compute_variance(LineDifference const& difference, std::vector<Vec2d> const& sigma);

}  // namespace gladstone::inline density
