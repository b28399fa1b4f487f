#include "analysis/correlation/steep_refinement.h"

#include <algorithm>
#include <cstdlib>
#include <utility>

#include "render/base/contracts.h"

namespace gladstone::inline correlation {
namespace {

constexpr int fitted_steps = 2;  ///< half-width of the neighbourhood from which a node is extrapolated [nodes]

/// Returns the largest value in the square of 2 reach + 1 nodes around every node.
std::vector<double> largest_around(std::vector<double> const& values, InterrogationGrid const& grid, int reach) {
  std::vector<double> across(values.size()), result(values.size());
  auto const largest = [&](std::vector<double> const& from, int row, int column, int step, int at, int count) {
    double most = from[static_cast<std::size_t>(row) * grid.columns + column];
    for (int d = -std::min(reach, at); d <= std::min(reach, count - 1 - at); ++d)
      most = std::max(most, from[static_cast<std::size_t>(row * grid.columns + column + d * step)]);
    return most;
  };
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column)
      across[static_cast<std::size_t>(row) * grid.columns + column] =
          largest(values, row, column, 1, column, grid.columns);
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column)
      result[static_cast<std::size_t>(row) * grid.columns + column] =
          largest(across, row, column, grid.columns, row, grid.rows);
  return result;
}

/// Weighted sums for the least-squares fit of a plane to nodes around a position.
class PlaneFit {
 public:
  void add(int dx, int dy, Vec2d value) {
    double const x = dx, y = dy, w = 1.0 / (x * x + y * y);
    sum_ += w;
    x_ += w * x;
    y_ += w * y;
    xx_ += w * x * x;
    xy_ += w * x * y;
    yy_ += w * y * y;
    value_ += w * value;
    x_value_ += (w * x) * value;
    y_value_ += (w * y) * value;
  }
  /// Returns the plane's value at the position; the mean of the nodes if they do not define the slopes.
  /// @pre at least one node was added
  Vec2d value() const {
    double const mean_x = x_ / sum_, mean_y = y_ / sum_;
    double const a = xx_ - x_ * mean_x, b = xy_ - x_ * mean_y, c = yy_ - y_ * mean_y, determinant = a * c - b * b;
    Vec2d const mean = (1.0 / sum_) * value_;
    // The determinant of nodes on one line is zero apart from rounding; for all other nodes it is at least 0.01 sum^2.
    if (determinant < 1e-3 * sum_ * sum_) return mean;
    Vec2d const p = x_value_ - x_ * mean, q = y_value_ - y_ * mean;
    Vec2d const slope_x = (1.0 / determinant) * (c * p - b * q), slope_y = (1.0 / determinant) * (a * q - b * p);
    return mean - mean_x * slope_x - mean_y * slope_y;
  }

 private:
  double sum_ = 0.0, x_ = 0.0, y_ = 0.0, xx_ = 0.0, xy_ = 0.0, yy_ = 0.0;
  Vec2d value_, x_value_, y_value_;
};

/// Calls visit(dx, dy, k) for the other nodes of the grid up to `steps` away from node i.
template <class Visit>
void visit_around(int i, InterrogationGrid const& grid, int steps, Visit const& visit) {
  int const column = i % grid.columns, row = i / grid.columns;
  for (int dy = -std::min(steps, row); dy <= std::min(steps, grid.rows - 1 - row); ++dy)
    for (int dx = -std::min(steps, column); dx <= std::min(steps, grid.columns - 1 - column); ++dx)
      if (dx != 0 || dy != 0) visit(dx, dy, i + dy * grid.columns + dx);
}

/// Extrapolates the unknown nodes in rounds, from the border of each group of unknown nodes inwards. Each round uses
/// the nodes that were known before this round. Without any known node, all nodes remain unchanged.
void extrapolate(std::vector<Vec2d>& nodes, std::vector<char> known, InterrogationGrid const& grid) {
  std::vector<int> holes;
  for (int i = 0; i < static_cast<int>(nodes.size()); ++i)
    if (!known[static_cast<std::size_t>(i)]) holes.push_back(i);
  while (!holes.empty()) {
    std::vector<int> left, done;
    std::vector<Vec2d> values;
    for (int const i : holes) {
      bool beside = false;
      visit_around(i, grid, 1, [&](int, int, int k) { beside = beside || known[static_cast<std::size_t>(k)]; });
      if (!beside) {
        left.push_back(i);
        continue;
      }
      PlaneFit fit;
      visit_around(i, grid, fitted_steps, [&](int dx, int dy, int k) {
        if (known[static_cast<std::size_t>(k)]) fit.add(dx, dy, nodes[static_cast<std::size_t>(k)]);
      });
      done.push_back(i);
      values.push_back(fit.value());
    }
    if (done.empty()) return;
    for (std::size_t n = 0; n < done.size(); ++n) {
      nodes[static_cast<std::size_t>(done[n])] = values[n];
      known[static_cast<std::size_t>(done[n])] = true;
    }
    holes = std::move(left);
  }
}

/// Returns whether a vector was measured, regardless of the result of its validation.
bool counts(GridVector const& vector) { return vector.status != VectorStatus::masked && is_measured(vector); }

}  // namespace

bool has_steep_gradient(std::span<GridVector const> vectors, InterrogationGrid const& grid) {
  GLADSTONE_EXPECTS(vectors.size() == grid.size());
  for (int i = 0; i < static_cast<int>(vectors.size()); ++i)
    if (is_steep(vectors.data(), i, grid)) return true;
  return false;
}

RefinementPlan plan_refinement(std::span<GridVector const> vectors, InterrogationGrid const& grid,
                               double min_fraction) {
  GLADSTONE_EXPECTS(vectors.size() == grid.size());
  int const reach = std::max(1, grid.window_px / grid.spacing_px);
  std::size_t const size = vectors.size();
  RefinementPlan plan{filled_displacement(vectors, grid.columns), std::vector<char>(size), std::vector<char>(size),
                      std::vector<char>(size)};
  std::vector<double> correlation(size), steep(size);
  std::vector<char> known(size, true);
  for (std::size_t i = 0; i < size; ++i) {
    correlation[i] = counts(vectors[i]) && is_valid_or_replaced(vectors[i].status) ? vectors[i].correlation : 0.0;
    visit_around(static_cast<int>(i), grid, 1, [&](int dx, int dy, int k) {
      std::size_t const beside = static_cast<std::size_t>(k);
      if (std::abs(dx) + std::abs(dy) == 1 &&
          is_steep(plan.nodes[i], plan.nodes[beside], vectors[i].correlation, vectors[beside].correlation, grid))
        steep[i] = 1.0;
    });
  }
  std::vector<double> const best = largest_around(correlation, grid, 2 * reach);
  steep = largest_around(steep, grid, reach);
  for (std::size_t i = 0; i < size; ++i) {
    plan.mismatched[i] =
        counts(vectors[i]) && (!is_valid_or_replaced(vectors[i].status) || correlation[i] < min_fraction * best[i]);
    known[i] = !plan.mismatched[i];
    plan.wanted[i] = steep[i] > 0.0 && vectors[i].status != VectorStatus::masked;
    plan.ambiguous[i] = vectors[i].ambiguous != Ambiguity::none && !plan.mismatched[i];
  }
  extrapolate(plan.nodes, std::move(known), grid);
  return plan;
}

double take_refined(RefinedPass& pass, RefinedPass const& refined, RefinementPlan const& plan,
                    ValidationRule const& rule) {
  GLADSTONE_EXPECTS(pass.vectors.size() == refined.vectors.size() && pass.windows.size() == refined.windows.size() &&
                    pass.vectors.size() == pass.windows.size() && plan.wanted.size() == pass.vectors.size());
  double largest = 0.0;
  for (std::size_t i = 0; i < pass.vectors.size(); ++i) {
    GridVector& before = pass.vectors[i];
    GridVector const& now = refined.vectors[i];
    if (!plan.wanted[i]) continue;
    if (plan.mismatched[i] && now.status == VectorStatus::masked) {
      reject_vector(before, FailedTest::displacement);
      if (rule.replaces) replace(before, {plan.nodes[i], VectorReason::neighbours}, rule);
    }
    if (!is_valid_or_replaced(now.status)) continue;
    bool const was_sound = is_valid_or_replaced(before.status);
    if (was_sound && now.correlation < min_fraction_of_earlier_correlation * before.correlation) continue;
    // A replaced vector is interpolated from its neighbours: it may replace a mismatched vector, but not a measured
    // one.
    if (now.status == VectorStatus::replaced && before.status == VectorStatus::valid && !plan.mismatched[i]) continue;
    if (was_sound) largest = std::max(largest, length(now.displacement - before.displacement));
    if (!was_sound) largest = std::max(largest, 2.0 * negligible_refinement_px);
    before = now;
    pass.windows[i] = refined.windows[i];
  }
  return largest;
}

}  // namespace gladstone::inline correlation
