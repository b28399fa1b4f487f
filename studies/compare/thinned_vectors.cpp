#include "studies/compare/thinned_vectors.h"

#include <algorithm>
#include <cmath>

#include "analysis/vectors/vector_file.h"
#include "render/base/contracts.h"

namespace gladstone::inline compare {
namespace {

/// Returns the indices of every n-th of `count` rows or columns, centred.
std::vector<int> select_every_nth(int count, int n) {
  std::vector<int> stay;
  for (int i = (count - 1) % n / 2; i < count; i += n) stay.push_back(i);
  return stay;
}

}  // namespace

int lattice_step(DisplacementField const& field, int least_apart_px) {
  if (field.columns < 2 || field.size() < 2) return 1;
  double const apart = std::abs(field.position_px[1].x - field.position_px[0].x);
  return apart > 0 ? std::max(1, static_cast<int>(std::ceil(least_apart_px / apart - 1e-9))) : 1;
}

DisplacementField every_nth(DisplacementField field, int n) {
  GLADSTONE_EXPECTS(n >= 1);
  if (n == 1 || field.columns == 0) return field;
  std::vector<int> const columns = select_every_nth(field.columns, n), rows = select_every_nth(field.rows, n);
  std::vector<std::size_t> kept;
  for (int const row : rows) {
    for (int const column : columns) kept.push_back(static_cast<std::size_t>(row * field.columns + column));
  }
  take_vectors(field, kept);
  field.columns = static_cast<int>(columns.size());
  field.rows = static_cast<int>(rows.size());
  return field;
}

}  // namespace gladstone::inline compare
