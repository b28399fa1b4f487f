#include "analysis/vector_validation.h"

#include <Eigen/Dense>
#include <algorithm>

#include "render/base/contracts.h"

namespace gladstone {
namespace {

constexpr int fewest_neighbours = 3;

/// The neighbours of vector i for which usable(index) holds.
/// @param offset where not null, receives their positions on the grid relative to i
template <class Usable>
Neighbours<double> neighbours_of(std::size_t i, int columns, int rows, auto const& displacement, Usable const& usable,
                                 Vec2d* offset = nullptr) {
  int const column = static_cast<int>(i % static_cast<std::size_t>(columns));
  int const row = static_cast<int>(i / static_cast<std::size_t>(columns));
  Neighbours<double> result;
  for (int y = std::max(0, row - 1); y <= std::min(rows - 1, row + 1); ++y)
    for (int x = std::max(0, column - 1); x <= std::min(columns - 1, column + 1); ++x) {
      std::size_t const k = static_cast<std::size_t>(y) * columns + x;
      if (k == i || !usable(k)) continue;
      if (offset != nullptr) offset[result.count] = {static_cast<double>(x - column), static_cast<double>(y - row)};
      result.value[result.count++] = displacement(k);
    }
  return result;
}

/// The neighbours less the slopes of the plane that fits them best (least squares).
Neighbours<double> without_slope(Neighbours<double> neighbours, Vec2d const* offset) {
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Matrix<double, 3, 2> right = Eigen::Matrix<double, 3, 2>::Zero();
  for (int k = 0; k < neighbours.count; ++k) {
    Eigen::Vector3d const basis(1.0, offset[k].x, offset[k].y);
    normal += basis * basis.transpose();
    right += basis * Eigen::RowVector2d(neighbours.value[k].x, neighbours.value[k].y);
  }
  Eigen::FullPivLU<Eigen::Matrix3d> const solver(normal);
  if (!solver.isInvertible()) return neighbours;  // all in one line: no plane
  Eigen::Matrix<double, 3, 2> const plane = solver.solve(right);
  for (int k = 0; k < neighbours.count; ++k)
    for (int axis = 0; axis < 2; ++axis) {
      double& value = axis == 0 ? neighbours.value[k].x : neighbours.value[k].y;
      value -= plane(1, axis) * offset[k].x + plane(2, axis) * offset[k].y;
    }
  return neighbours;
}

}  // namespace

void validate_vectors(std::span<GridVector> vectors, int columns, ValidationRule const& rule) {
  GLADSTONE_EXPECTS(columns > 0 && vectors.size() % columns == 0);
  int const rows = static_cast<int>(vectors.size()) / columns;
  auto const displacement = [&](std::size_t k) { return vectors[k].displacement; };

  std::vector<std::size_t> spurious;
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    if (vectors[i].status != VectorStatus::valid) continue;
    Vec2d offset[Neighbours<double>::capacity];
    auto const around = neighbours_of(
        i, columns, rows, displacement, [&](std::size_t k) { return vectors[k].status == VectorStatus::valid; },
        offset);
    auto const agrees = [&](Neighbours<double> const& neighbours) {
      return normalised_median_residual(vectors[i].displacement, neighbours, rule.epsilon_px) <= rule.threshold;
    };
    if (around.count < fewest_neighbours || agrees(around)) continue;
    if (around.count < Neighbours<double>::capacity && agrees(without_slope(around, offset))) continue;
    spurious.push_back(i);
  }
  for (std::size_t const i : spurious) vectors[i].status = VectorStatus::invalid;

  // rounds from the rim of a spurious patch inwards; within a round only what was sound before counts
  while (!spurious.empty()) {
    std::vector<std::size_t> left;
    std::vector<std::pair<std::size_t, Vec2d>> replaced;
    for (std::size_t const i : spurious) {
      auto const around = neighbours_of(i, columns, rows, displacement, [&](std::size_t k) {
        return vectors[k].status == VectorStatus::valid || vectors[k].status == VectorStatus::replaced;
      });
      if (around.count < fewest_neighbours) {
        left.push_back(i);
        continue;
      }
      Vec2d value = around.median();
      for (int k = vectors[i].alternative_count - 1; k >= 0; --k)
        if (normalised_median_residual(vectors[i].alternatives[k], around, rule.epsilon_px) <= rule.threshold)
          value = vectors[i].alternatives[k];
      replaced.emplace_back(i, value);
    }
    for (auto const& [i, value] : replaced) {
      vectors[i].displacement = value;
      vectors[i].status = VectorStatus::replaced;
    }
    if (replaced.empty()) break;
    spurious = std::move(left);
  }
}

std::vector<Vec2d> filled_displacement(std::span<GridVector const> vectors, int columns) {
  GLADSTONE_EXPECTS(columns > 0 && vectors.size() % columns == 0);
  int const rows = static_cast<int>(vectors.size()) / columns;
  std::vector<Vec2d> filled(vectors.size());
  std::vector<char> known(vectors.size(), false);
  std::vector<std::size_t> holes;
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    known[i] = vectors[i].status == VectorStatus::valid || vectors[i].status == VectorStatus::replaced;
    if (known[i])
      filled[i] = vectors[i].displacement;
    else
      holes.push_back(i);
  }
  if (holes.size() == vectors.size()) return filled;
  while (!holes.empty()) {
    std::vector<std::size_t> left, done;
    for (std::size_t const i : holes) {
      auto const around = neighbours_of(
          i, columns, rows, [&](std::size_t k) { return filled[k]; }, [&](std::size_t k) { return known[k] != 0; });
      if (around.count == 0) {
        left.push_back(i);
        continue;
      }
      filled[i] = around.median();
      done.push_back(i);
    }
    for (std::size_t const i : done) known[i] = true;
    holes = std::move(left);
  }
  return filled;
}

std::vector<Vec2d> smoothed_displacement(std::span<Vec2d const> nodes, int columns) {
  GLADSTONE_EXPECTS(columns > 0 && nodes.size() % columns == 0);
  int const rows = static_cast<int>(nodes.size()) / columns;
  std::vector<Vec2d> across(nodes.begin(), nodes.end()), result;
  for (int j = 0; j < rows; ++j)
    for (int i = 1; i + 1 < columns; ++i) {
      std::size_t const k = static_cast<std::size_t>(j) * columns + i;
      across[k] = 0.125 * (nodes[k - 1] + 6.0 * nodes[k] + nodes[k + 1]);
    }
  result = across;
  for (int j = 1; j + 1 < rows; ++j)
    for (int i = 0; i < columns; ++i) {
      std::size_t const k = static_cast<std::size_t>(j) * columns + i;
      result[k] = 0.125 * (across[k - columns] + 6.0 * across[k] + across[k + columns]);
    }
  return result;
}

}  // namespace gladstone
