#pragma once

#include <Eigen/SparseCholesky>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "analysis/density/gradient_map.h"

namespace gladstone::inline density {

/// Linear continuation of a density into its holes by the five-point Laplace equation, with natural conditions at the
/// borders of the grid.
class HarmonicContinuation {
 public:
  /// @param determined  1 for nodes with a density, 0 for holes [grid.size()]
  /// @pre at least one node has a density
  HarmonicContinuation(PlaneGrid const& grid, std::span<std::uint8_t const> determined);
  /// Replaces the values in the holes.
  /// @param density  density at every node [grid.size()]; ignored in the holes
  Eigen::VectorXd fill(std::span<double const> density) const;

 private:
  /// Link between a node in a hole and a neighbour that has a density.
  struct Link {
    std::size_t hole, node;
    double weight;  ///< coefficient of the neighbour in the Laplace equation [1/m^2]
  };
  std::vector<std::size_t> hole_;
  std::vector<Link> outer_;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> laplace_;
};

}  // namespace gladstone::inline density
