#include "studies/compare/reconstruct_axisymmetric.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/not_a_number.h"

namespace gladstone::inline compare {
namespace {

/// Threshold of AxisymmetryResult::border_gradient above which a warning is issued.
constexpr double noticeable_border_gradient = 0.1;

/// Threshold of AxisymmetryResult::asymmetry above which a warning is issued.
constexpr double noticeable_asymmetry = 0.3;

/// Differences of a density between neighbouring nodes, one-sided at borders and holes [kg/m^4].
std::vector<Vec2d> differentiate_density(density::PlaneGrid const& grid, std::vector<double> const& density) {
  std::vector<Vec2d> gradient;
  auto const value = [&](int column, int row) {
    return grid.contains(column, row) ? density[grid.index(column, row)] : not_a_number;
  };
  auto const slope = [](double before, double here, double after, double step) {
    if (!std::isfinite(here)) return not_a_number;
    if (std::isfinite(before) && std::isfinite(after)) return (after - before) / (2.0 * step);
    return std::isfinite(before) ? (here - before) / step : (after - here) / step;
  };
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column) {
      double const here = value(column, row);
      gradient.push_back({slope(value(column - 1, row), here, value(column + 1, row), grid.spacing.x),
                          slope(value(column, row - 1), here, value(column, row + 1), grid.spacing.y)});
    }
  return gradient;
}

/// Sets grid, density and sigma_random of the result by mirroring a radial density about its axis. The nodes are at
/// integer multiples of the spacing from the axis, within the measured grid.
void mirror_density(Reconstruction& result, density::AxisymmetricDensity const& half,
                    density::PlaneGrid const& measured) {
  using density::AxisDirection;
  bool const is_vertical = result.axisymmetry->direction == AxisDirection::vertical;
  double const axis = half.axis.position, step = half.grid.spacing.x;
  double const first = is_vertical ? measured.origin.x : measured.origin.y;
  int const nodes = is_vertical ? measured.columns : measured.rows;
  int const before = std::min(half.grid.columns - 1, static_cast<int>(std::floor((axis - first) / step + 1e-9)));
  int const after =
      std::min(half.grid.columns - 1, static_cast<int>(std::floor((first + (nodes - 1) * step - axis) / step + 1e-9)));
  int const across = before + after + 1;
  double const origin = axis - before * step;
  result.grid = is_vertical
                    ? density::PlaneGrid{across, measured.rows, {origin, measured.origin.y}, measured.spacing}
                    : density::PlaneGrid{measured.columns, across, {measured.origin.x, origin}, measured.spacing};
  result.density.resize(result.grid.size());
  result.sigma_random.resize(result.grid.size());
  for (int along = 0; along < half.grid.rows; ++along)
    for (int i = 0; i < across; ++i) {
      std::size_t const from = half.grid.index(std::abs(i - before), along);
      std::size_t const to = is_vertical ? result.grid.index(i, along) : result.grid.index(along, i);
      result.density[to] = half.density[from];
      result.sigma_random[to] = half.sigma[from];
    }
}

}  // namespace

Reconstruction invert_flow(Reconstruction result, density::GradientMap const& projected,
                           std::array<double, 2> axis_range, ReconstructOptions const& options) {
  using namespace density;
  AxisymmetricSettings settings;
  settings.axis_range = axis_range;
  settings.direction = options.axis->direction;
  settings.axis = options.axis->position;
  settings.method = options.abel;
  if (options.lambda) {
    settings.choice = RegularizationChoice::given;
    settings.lambda = *options.lambda;
  }
  settings.overlap = result.overlap;
  settings.ambient_density = result.reference_density;
  AxisymmetricDensity const half = invert_axisymmetric(projected, settings);
  result.axisymmetry = {settings.direction, half.axis, half.lambda, half.asymmetry, half.border_gradient};
  mirror_density(result, half, projected.grid);
  result.gradient = differentiate_density(result.grid, result.density);
  for (double const density : result.density) result.region.push_back(std::isfinite(density) ? 0 : -1);
  result.reference.assign(result.grid.size(), 0);
  if (half.border_gradient > noticeable_border_gradient)
    result.warnings.push_back(
        {WarningCode::unsuitable, "",
         fmt::format("the gradient at the largest radii is {:.0f} % of that of all radii, so that the flow extends "
                     "beyond the vectors and the density is biased; enlarge the field of view",
                     100.0 * half.border_gradient)});
  if (half.asymmetry > noticeable_asymmetry)
    result.warnings.push_back(
        {WarningCode::unreliable, "",
         fmt::format("the even part of the gradient about the axis is {:.0f} % of the odd part: the axis is wrong, the "
                     "flow is not axisymmetric, or the vectors are noisy; check --axis",
                     100.0 * half.asymmetry)});
  return result;
}

}  // namespace gladstone::inline compare
