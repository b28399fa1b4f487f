#include "analysis/density/gradient_map.h"

#include <fmt/format.h>

#include <algorithm>

#include "render/base/error.h"

namespace gladstone::inline density {
namespace {

/// Throws DataError if `is_bad` is true for any valid node; the message contains the number of such nodes and the
/// position of the first one.
template <class Predicate>
void reject_nodes(GradientMap const& map, Predicate const& is_bad, char const* problem, char const* remedy) {
  std::size_t count = 0, first = 0;
  for (std::size_t i = 0; i < map.grid.size(); ++i) {
    if (map.valid[i] == 0 || !is_bad(i)) continue;
    if (count++ == 0) first = i;
  }
  if (count == 0) return;
  auto const columns = static_cast<std::size_t>(map.grid.columns);
  throw DataError(ErrorCode::invalid_value, "density gradient",
                  fmt::format("{} at {} valid nodes (first: column {}, row {}); {}", problem, count, first % columns,
                              first / columns, remedy));
}

}  // namespace

void check_gradient_map(GradientMap const& map) {
  std::size_t const size = map.grid.size();
  if (map.grid.columns < 2 || map.grid.rows < 2)
    throw DataError(ErrorCode::wrong_shape, "density gradient",
                    fmt::format("the grid has {} x {} nodes (a density requires at least 2 x 2); "
                                "use smaller windows or more overlap",
                                map.grid.columns, map.grid.rows));
  if (!(map.grid.spacing.x > 0.0 && map.grid.spacing.y > 0.0))
    throw DataError(ErrorCode::out_of_range, "density gradient",
                    "the spacing of the grid is not positive; check the vectors' positions");
  if (map.gradient.size() != size || map.valid.size() != size || (!map.sigma.empty() && map.sigma.size() != size))
    throw DataError(
        ErrorCode::wrong_shape, "density gradient",
        fmt::format("got {} gradients, {} sigmas and {} validity flags for {} nodes; give one of each per node",
                    map.gradient.size(), map.sigma.size(), map.valid.size(), size));
  if (std::none_of(map.valid.begin(), map.valid.end(), [](std::uint8_t v) { return v != 0; }))
    throw DataError(ErrorCode::no_valid_vector, "density gradient",
                    "no node is valid; check the mask and the validation of the vectors");
  reject_nodes(
      map, [&](std::size_t i) { return !is_finite(map.gradient[i]); }, "the gradient is not finite",
      "mark these nodes as invalid");
  if (map.sigma.empty()) return;
  reject_nodes(
      map, [&](std::size_t i) { return !is_finite(map.sigma[i]) || map.sigma[i].x <= 0.0 || map.sigma[i].y <= 0.0; },
      "the uncertainty is not a positive number", "estimate the uncertainty for every vector, or for none");
}

}  // namespace gladstone::inline density
