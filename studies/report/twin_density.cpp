#include "studies/report/twin_density.h"

#include <algorithm>

#include "analysis/density/density_integrator.h"
#include "analysis/density/harmonic_continuation.h"
#include "render/base/contracts.h"
#include "render/base/not_a_number.h"

namespace gladstone::inline report {
namespace {

double border_mean(Image<double> const& image) {
  double sum = 0;
  int count = 0;
  for (int row = 0; row < image.rows(); ++row) {
    for (int column = 0; column < image.columns(); ++column) {
      bool const border = row == 0 || column == 0 || row == image.rows() - 1 || column == image.columns() - 1;
      if (!border) continue;
      sum += image(column, row);
      ++count;
    }
  }
  return sum / count;
}

/// Converts gradients with rows downwards to a map with rows upwards.
density::GradientMap make_gradient_map(std::vector<Vec2d> const& gradient, int columns, int rows, double spacing) {
  density::GradientMap map{{columns, rows, {}, {spacing, spacing}}, {}, {}, {}};
  for (int row = rows - 1; row >= 0; --row) {
    for (int column = 0; column < columns; ++column) {
      map.gradient.push_back(gradient[map.grid.index(column, row)]);
      map.valid.push_back(is_finite(map.gradient.back()) ? 1 : 0);
    }
  }
  return map;
}

}  // namespace

Image<double> compute_twin_density(std::vector<Vec2d> const& gradient, int columns, int rows, double spacing) {
  GLADSTONE_EXPECTS(columns >= 2 && rows >= 2 && gradient.size() == static_cast<std::size_t>(columns) * rows);
  density::GradientMap const map = make_gradient_map(gradient, columns, rows, spacing);
  density::check_gradient_map(map);

  // Fix the density at one node of the largest region
  std::vector<int> const label = density::find_regions(map).label;
  density::ReferenceDensity reference{std::vector<double>(map.grid.size(), not_a_number)};
  reference.value[static_cast<std::size_t>(std::find(label.begin(), label.end(), 0) - label.begin())] = 0.0;
  density::IntegrationSettings settings;
  settings.unreferenced = density::UnreferencedRegions::leave_out;
  density::DensityIntegrator const integrator(map, reference, settings);
  density::HarmonicContinuation const continuation(map.grid, integrator.determined());
  auto const filled = continuation.fill(integrator.integrate(map.gradient));

  Image<double> density(columns, rows);
  for (int row = 0; row < rows; ++row) {
    for (int column = 0; column < columns; ++column)
      density(column, row) = filled[static_cast<Eigen::Index>(map.grid.index(column, rows - 1 - row))];
  }
  double const level = border_mean(density);
  for (double& value : density) value -= level;
  return density;
}

}  // namespace gladstone::inline report
