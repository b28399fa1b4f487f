#include "analysis/tomography/projected_density.h"

#include <cmath>

#include "analysis/density/density_integrator.h"
#include "analysis/density/projected_gradient.h"
#include "render/base/contracts.h"
#include "render/base/not_a_number.h"

namespace gladstone::inline tomography {
namespace {

/// Optics for which compute_projected_gradient() returns (-u, v) on a grid in px: sensitivity and size of a pixel in
/// the mid-plane are 1.
density::ProjectionOptics pixel_optics() { return {1.0, 1.0, 1.0, 2.0, 2.0, 1.0, {}}; }

/// Factors that convert the displacement to the gradient of the projected density per pixel [kg/m^2/px^2].
struct GradientFactors {
  double column_by_u, column_by_v, row_by_u, row_by_v;
};

GradientFactors find_factors(VectorSight const& sight, ViewOptics const& optics) {
  SightLine const& line = sight.line;
  double const factor = -optics.ambient_index * line.scale / (optics.gladstone_dale * line.pupil_distance);
  Vec3d const d = line.direction;
  auto const across = [&](Vec3d a, Vec3d b) { return factor * (dot(a, b) - dot(a, d) * dot(b, d)); };
  double const mixed = across(sight.by_column, sight.by_row);
  return {across(sight.by_column, sight.by_column), mixed, mixed, across(sight.by_row, sight.by_row)};
}

}  // namespace

density::GradientMap compute_pixel_gradient(DisplacementField const& field, ViewOptics const& optics) {
  GLADSTONE_EXPECTS(optics.sights.size() == field.size());
  DisplacementField seen = field;
  seen.status.resize(seen.size(), VectorStatus::valid);
  for (std::size_t i = 0; i < seen.size(); ++i)
    if (!optics.sights[i]) seen.status[i] = VectorStatus::masked;
  density::GradientMap map = density::compute_projected_gradient(seen, pixel_optics()).map;
  for (int row = 0; row < map.grid.rows; ++row)
    for (int column = 0; column < map.grid.columns; ++column) {
      std::size_t const node = map.grid.index(column, row);
      if (map.valid[node] == 0) continue;
      std::size_t const vector = map.grid.index(column, map.grid.rows - 1 - row);
      GradientFactors const f = find_factors(*optics.sights[vector], optics);
      double const u = -map.gradient[node].x, v = map.gradient[node].y;
      map.gradient[node] = {f.column_by_u * u + f.column_by_v * v, -(f.row_by_u * u + f.row_by_v * v)};
      if (map.sigma.empty()) continue;
      Vec2d const sigma = map.sigma[node];
      map.sigma[node] = {std::hypot(f.column_by_u * sigma.x, f.column_by_v * sigma.y),
                         std::hypot(f.row_by_u * sigma.x, f.row_by_v * sigma.y)};
    }
  return map;
}

ProjectedView integrate_view(density::GradientMap const& gradient, ViewOptics const& optics,
                             density::ReferenceDensity const& reference) {
  density::IntegrationSettings settings;
  settings.unreferenced = density::UnreferencedRegions::leave_out;
  std::vector<double> const integrated =
      density::DensityIntegrator(gradient, reference, settings).integrate(gradient.gradient);
  ProjectedView view;
  view.lines.resize(integrated.size());
  view.value.assign(integrated.size(), not_a_number);
  for (int row = 0; row < gradient.grid.rows; ++row)
    for (int column = 0; column < gradient.grid.columns; ++column) {
      std::size_t const vector = gradient.grid.index(column, gradient.grid.rows - 1 - row);
      if (!optics.sights[vector]) continue;
      view.lines[vector] = optics.sights[vector]->line;
      view.value[vector] = integrated[gradient.grid.index(column, row)];
    }
  return view;
}

}  // namespace gladstone::inline tomography
