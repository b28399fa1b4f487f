#include "studies/compare/map_refinement.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "render/base/contracts.h"
#include "render/base/not_a_number.h"

namespace gladstone::inline compare {
namespace {

bool is_known(Vec2d value) { return std::isfinite(value.x) && std::isfinite(value.y); }

/// Nodes of a lattice along an axis, and their weights at a position: Lagrange's interpolation.
struct Stencil {
  int first = 0, count = 1;
  std::array<double, 4> weight{1, 0, 0, 0};

  /// @param size  number of nodes of spacing 1 along the axis
  Stencil(int place, int spacing, int size) : first(place / spacing) {
    if (place % spacing == 0) return;
    int const nodes = (size - 1) / spacing + 1;
    count = std::min(4, nodes);
    first = std::clamp(first - 1, 0, nodes - count);
    double const at = static_cast<double>(place) / spacing - first;
    for (int i = 0; i < count; ++i) {
      weight[i] = 1;
      for (int j = 0; j < count; ++j)
        if (j != i) weight[i] *= (at - j) / (i - j);
    }
  }
};

/// Map that is computed on successively finer lattices.
class Refinement {
 public:
  Refinement(int columns, int rows, MapSampler const& sample)
      : value_(columns, rows, {not_a_number, not_a_number}), deviates_(columns, rows), sample_(sample) {}

  /// Computes the values at all nodes of a lattice of the given spacing.
  void compute_lattice(int spacing) {
    std::vector<MapNode> nodes;
    for (int row = 0; row < value_.rows(); row += spacing)
      for (int column = 0; column < value_.columns(); column += spacing) nodes.push_back({column, row});
    MapSamples const samples = sample_(nodes);
    for (std::size_t i = 0; i < nodes.size(); ++i) value_(nodes[i].column, nodes[i].row) = samples.value[i];
  }

  /// Makes the nodes of half the spacing known.
  /// @param all  compute all of them, instead of those near deviations
  void refine(int spacing, bool all) {
    int const half = spacing / 2;
    std::vector<MapNode> computed;
    std::vector<Vec2d> expected;
    for (int row = 0; row < value_.rows(); row += half) {
      for (int column = 0; column < value_.columns(); column += half) {
        if (row % spacing == 0 && column % spacing == 0) continue;
        auto const [prediction, at_border] = predict(column, row, spacing);
        value_(column, row) = prediction;
        if (!all && !at_border && !deviates_near(column, row, spacing)) continue;
        computed.push_back({column, row});
        expected.push_back(prediction);
      }
    }
    MapSamples const samples = sample_(computed);
    deviates_ = Image<char>(value_.columns(), value_.rows());
    for (std::size_t i = 0; i < computed.size(); ++i) {
      auto const [column, row] = computed[i];
      Vec2d const value = samples.value[i], deviation = value - expected[i];
      Vec2d const error = samples.error.empty() ? Vec2d{} : samples.error[i];
      value_(column, row) = value;
      bool const agrees = std::abs(deviation.x) <= tolerance(error.x) && std::abs(deviation.y) <= tolerance(error.y);
      deviates_(column, row) = !agrees && (is_known(value) || is_known(expected[i]));
    }
  }

  Vec2d value(int column, int row) const { return value_(column, row); }

 private:
  struct Prediction {
    Vec2d value{};
    bool at_border = false;  ///< some, but not all, of the nodes required for the interpolation are unknown
  };

  static double tolerance(double error) { return refinement_tolerance + (error > 0 ? 4 * error : 0); }

  Prediction predict(int column, int row, int spacing) const {
    Stencil const across(column, spacing, value_.columns()), down(row, spacing, value_.rows());
    Prediction found;
    int known = 0;
    for (int j = 0; j < down.count; ++j) {
      for (int i = 0; i < across.count; ++i) {
        Vec2d const node = value_((across.first + i) * spacing, (down.first + j) * spacing);
        found.value += across.weight[i] * down.weight[j] * node;
        known += is_known(node) ? 1 : 0;
      }
    }
    found.at_border = known > 0 && known < across.count * down.count;
    return found;
  }

  /// Returns true if a node of the last level within the spacing of the lattice deviates from its interpolation.
  bool deviates_near(int column, int row, int spacing) const {
    auto const first = [&](int place) { return std::max(0, (place - 1) / spacing * spacing); };
    for (int r = first(row); r <= std::min(row + spacing, value_.rows() - 1); r += spacing)
      for (int c = first(column); c <= std::min(column + spacing, value_.columns() - 1); c += spacing)
        if (deviates_(c, r) != 0) return true;
    return false;
  }

  Image<Vec2d> value_;
  Image<char> deviates_;  ///< nodes of the last level that deviate from their interpolation by more than the tolerance
  MapSampler const& sample_;
};

}  // namespace

Image<Vec2d> refine_map(int columns, int rows, int coarsest, MapSampler const& sample) {
  GLADSTONE_EXPECTS(coarsest >= 1);
  auto const complete = [coarsest](int size) { return (size + coarsest - 2) / coarsest * coarsest + 1; };
  Refinement refinement(complete(columns), complete(rows), sample);
  refinement.compute_lattice(coarsest);
  for (int spacing = coarsest; spacing > 1; spacing /= 2) refinement.refine(spacing, spacing == coarsest);
  Image<Vec2d> map(columns, rows);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) map(column, row) = refinement.value(column, row);
  return map;
}

}  // namespace gladstone::inline compare
