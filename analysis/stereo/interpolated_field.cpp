#include "analysis/stereo/interpolated_field.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/stereo/cubic_convolution.h"
#include "render/base/contracts.h"
#include "render/base/not_a_number.h"

namespace gladstone::inline stereo {
namespace {

Vec2d find_spacing(DisplacementField const& field) {
  Vec2d const extent = field.position_px.back() - field.position_px.front();
  return {extent.x / (field.columns - 1), extent.y / (field.rows - 1)};
}

std::array<double, 4> linear_weights(double t) { return {0.0, 1.0 - t, t, 0.0}; }

/// Index of the interval of the grid that contains a coordinate, and the position within it, 0 to 1.
struct Interval {
  int index;
  double fraction;
};

/// @return interval of a coordinate; its index is -1 outside the grid
Interval find_interval(double coordinate, int nodes) {
  constexpr double slack = 1e-9;  // tolerance for points on the border, relative to the distance between nodes
  if (!(coordinate >= -slack && coordinate <= nodes - 1 + slack)) return {-1, 0.0};
  int const index = std::clamp(static_cast<int>(std::floor(coordinate)), 0, nodes - 2);
  return {index, std::clamp(coordinate - index, 0.0, 1.0)};
}

/// Returns the correlation of the errors of two vectors at a distance (dx_px, dy_px).
double error_correlation(double dx_px, double dy_px, double window_px) {
  if (dx_px == 0.0 && dy_px == 0.0) return 1.0;
  if (!(window_px > 0.0)) return 0.0;
  return std::max(0.0, 1.0 - std::abs(dx_px) / window_px) * std::max(0.0, 1.0 - std::abs(dy_px) / window_px);
}

}  // namespace

bool is_regular_grid(DisplacementField const& field) {
  constexpr double tolerance_px = 0.02;  // twice the tolerance of arrange_as_grid()
  if (field.columns < 2 || field.rows < 2) return false;
  if (field.size() != static_cast<std::size_t>(field.columns) * static_cast<std::size_t>(field.rows)) return false;
  Vec2d const spacing = find_spacing(field), first = field.position_px.front();
  if (!(spacing.x > tolerance_px && spacing.y > tolerance_px)) return false;
  for (std::size_t i = 0; i < field.size(); ++i) {
    auto const columns = static_cast<std::size_t>(field.columns);
    std::size_t const column = i % columns, row = i / columns;
    Vec2d const node{first.x + spacing.x * static_cast<double>(column), first.y + spacing.y * static_cast<double>(row)};
    Vec2d const off = field.position_px[i] - node;
    if (!(std::abs(off.x) <= tolerance_px && std::abs(off.y) <= tolerance_px)) return false;
  }
  return true;
}

InterpolatedField::InterpolatedField(DisplacementField const& field, double window_px)
    : field_(&field), window_px_(window_px) {
  GLADSTONE_EXPECTS(is_regular_grid(field));
  first_ = field.position_px.front();
  spacing_ = find_spacing(field);
}

std::vector<InterpolatedField::Node> InterpolatedField::nodes_around(Vec2d position_px) const {
  Vec2d const off = position_px - first_;
  Interval const x = find_interval(off.x / spacing_.x, field_->columns);
  Interval const y = find_interval(off.y / spacing_.y, field_->rows);
  if (x.index < 0 || y.index < 0) return {};
  for (auto const weights : {cubic_weights, linear_weights}) {
    std::vector<Node> nodes;
    bool complete = true;
    std::array<double, 4> const by_column = weights(x.fraction), by_row = weights(y.fraction);
    for (int j = 0; j < 4; ++j) {
      for (int i = 0; i < 4; ++i) {
        double const weight = by_column[static_cast<std::size_t>(i)] * by_row[static_cast<std::size_t>(j)];
        if (weight == 0.0) continue;
        int const column = x.index + i - 1, row = y.index + j - 1;
        if (column < 0 || row < 0 || column >= field_->columns || row >= field_->rows) {
          complete = false;
          continue;
        }
        std::size_t const index = static_cast<std::size_t>(row) * static_cast<std::size_t>(field_->columns) +
                                  static_cast<std::size_t>(column);
        complete = complete && field_->counts(index) && is_finite(field_->displacement_px[index]);
        nodes.push_back({index, column, row, weight});
      }
    }
    if (complete) return nodes;
  }
  return {};
}

std::optional<Vec2d> InterpolatedField::displacement(Vec2d position_px) const {
  std::vector<Node> const nodes = nodes_around(position_px);
  if (nodes.empty()) return std::nullopt;
  Vec2d sum{};
  for (Node const& node : nodes) sum += node.weight * field_->displacement_px[node.index];
  return sum;
}

std::optional<InterpolatedField::Vector> InterpolatedField::vector(Vec2d position_px) const {
  std::vector<Node> const nodes = nodes_around(position_px);
  if (nodes.empty()) return std::nullopt;
  Vector result{{}, {not_a_number, not_a_number}};
  for (Node const& node : nodes) result.displacement_px += node.weight * field_->displacement_px[node.index];
  if (field_->sigma_px.empty()) return result;
  Vec2d variance{};
  for (Node const& a : nodes) {
    for (Node const& b : nodes) {
      double const share =
          a.weight * b.weight *
          error_correlation(spacing_.x * (a.column - b.column), spacing_.y * (a.row - b.row), window_px_);
      Vec2d const sigma_a = field_->sigma_px[a.index], sigma_b = field_->sigma_px[b.index];
      variance += share * Vec2d{sigma_a.x * sigma_b.x, sigma_a.y * sigma_b.y};
    }
  }
  result.sigma_px = {std::sqrt(variance.x), std::sqrt(variance.y)};
  return result;
}

}  // namespace gladstone::inline stereo
