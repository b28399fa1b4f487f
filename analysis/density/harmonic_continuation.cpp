#include "analysis/density/harmonic_continuation.h"

#include <utility>

#include "render/base/contracts.h"

namespace gladstone::inline density {

HarmonicContinuation::HarmonicContinuation(PlaneGrid const& grid, std::span<std::uint8_t const> determined) {
  std::vector<int> unknown(grid.size(), -1);
  for (std::size_t i = 0; i < grid.size(); ++i)
    if (determined[i] == 0) {
      unknown[i] = static_cast<int>(hole_.size());
      hole_.push_back(i);
    }
  if (hole_.empty()) return;
  std::vector<Eigen::Triplet<double>> inner;
  for (std::size_t h = 0; h < hole_.size(); ++h) {
    int const column = static_cast<int>(hole_[h]) % grid.columns, row = static_cast<int>(hole_[h]) / grid.columns;
    for (auto const& [dx, dy] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
      if (!grid.contains(column + dx, row + dy)) continue;
      double const spacing = dx != 0 ? grid.spacing.x : grid.spacing.y, weight = 1.0 / (spacing * spacing);
      std::size_t const neighbour = grid.index(column + dx, row + dy);
      inner.emplace_back(static_cast<int>(h), static_cast<int>(h), weight);
      if (unknown[neighbour] >= 0)
        inner.emplace_back(static_cast<int>(h), unknown[neighbour], -weight);
      else
        outer_.push_back({h, neighbour, weight});
    }
  }
  auto const size = static_cast<Eigen::Index>(hole_.size());
  Eigen::SparseMatrix<double> matrix(size, size);
  matrix.setFromTriplets(inner.begin(), inner.end());
  laplace_.compute(matrix);
  GLADSTONE_ENSURES(laplace_.info() == Eigen::Success);
}

Eigen::VectorXd HarmonicContinuation::fill(std::span<double const> density) const {
  Eigen::VectorXd filled = Eigen::Map<Eigen::VectorXd const>(density.data(), static_cast<Eigen::Index>(density.size()));
  if (hole_.empty()) return filled;
  Eigen::VectorXd right_side = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(hole_.size()));
  for (Link const& link : outer_) right_side[static_cast<Eigen::Index>(link.hole)] += link.weight * density[link.node];
  Eigen::VectorXd const solution = laplace_.solve(right_side);
  for (std::size_t h = 0; h < hole_.size(); ++h)
    filled[static_cast<Eigen::Index>(hole_[h])] = solution[static_cast<Eigen::Index>(h)];
  return filled;
}

}  // namespace gladstone::inline density
