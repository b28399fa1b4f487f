#include "analysis/density/projected_gradient.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/base/error.h"

namespace gladstone::inline density {
namespace {

void check_optics(ProjectionOptics const& optics) {
  std::vector<SetupProblem> problems;
  auto const require_positive = [&](char const* name, double value) {
    if (!(value > 0.0) || !std::isfinite(value))
      problems.push_back({name, fmt::format("expected a positive number, got {}", value)});
  };
  require_positive("magnification", optics.magnification);
  require_positive("lens_distance", optics.lens_distance);
  require_positive("target_distance", optics.target_distance);
  require_positive("pixel_pitch", optics.pixel_pitch);
  require_positive("gladstone_dale", optics.gladstone_dale);
  require_positive("ambient_index", optics.ambient_index);
  if (!is_finite(optics.axis_px)) problems.push_back({"axis_px", "expected finite pixel coordinates"});
  if (!problems.empty()) throw SetupError(problems);
}

/// Interrogation grid of a field in px, with rows downwards.
struct PixelGrid {
  Vec2d first_px, step_px;
};

PixelGrid find_pixel_grid(DisplacementField const& field) {
  auto const columns = static_cast<std::size_t>(std::max(field.columns, 0));
  auto const rows = static_cast<std::size_t>(std::max(field.rows, 0));
  if (columns < 2 || rows < 2 || field.size() != columns * rows || field.displacement_px.size() != field.size())
    throw DataError(ErrorCode::wrong_shape, "vectors",
                    fmt::format("{} vectors do not form a grid of at least 2 x 2 (columns: {}, rows: {}); "
                                "interpolate scattered vectors onto a regular grid first",
                                field.size(), field.columns, field.rows));
  Vec2d const first = field.position_px.front(), last = field.position_px.back();
  PixelGrid const grid{
      first,
      {(last.x - first.x) / static_cast<double>(columns - 1), (last.y - first.y) / static_cast<double>(rows - 1)}};
  if (!(grid.step_px.x > 0.0 && grid.step_px.y > 0.0))
    throw DataError(ErrorCode::invalid_value, "vectors",
                    "the columns must run to the right and the rows downwards; reorder the vectors");
  for (std::size_t i = 0; i < field.size(); ++i) {
    std::size_t const row = i / columns, column = i % columns;
    Vec2d const expected{first.x + static_cast<double>(column) * grid.step_px.x,
                         first.y + static_cast<double>(row) * grid.step_px.y};
    if (!(length(field.position_px[i] - expected) <= 1e-3 * std::min(grid.step_px.x, grid.step_px.y)))
      throw DataError(ErrorCode::invalid_value, "vectors",
                      fmt::format("vector {} at ({:.4f}, {:.4f}) px is not on the regular grid, expected "
                                  "({:.4f}, {:.4f}) px; interpolate the vectors onto a regular grid first",
                                  i, field.position_px[i].x, field.position_px[i].y, expected.x, expected.y));
  }
  return grid;
}

/// Returns the largest finite sigma of each component, or 0 if no vector has a sigma.
Vec2d find_largest_sigma(DisplacementField const& field) {
  Vec2d largest{};
  for (std::size_t i = 0; i < field.sigma_px.size(); ++i) {
    Vec2d const sigma = field.sigma_px[i];
    if (!field.counts(i) || !is_finite(sigma)) continue;
    largest = {std::max(largest.x, sigma.x), std::max(largest.y, sigma.y)};
  }
  return largest;
}

}  // namespace

ProjectedGradient compute_projected_gradient(DisplacementField const& field, ProjectionOptics const& optics) {
  check_optics(optics);
  PixelGrid const pixels = find_pixel_grid(field);
  double const metres_per_px = optics.pixel_pitch / optics.medium_magnification();
  double const scale = 1.0 / optics.sensitivity();
  Vec2d const largest_sigma = find_largest_sigma(field);
  bool const has_sigma = largest_sigma.x > 0.0 && largest_sigma.y > 0.0;

  ProjectedGradient result;
  GradientMap& map = result.map;
  PlaneGrid& grid = map.grid;
  grid.columns = field.columns;
  grid.rows = field.rows;
  grid.spacing = metres_per_px * pixels.step_px;
  double const last_row_px = pixels.first_px.y + (field.rows - 1) * pixels.step_px.y;
  grid.origin = {metres_per_px * (pixels.first_px.x - optics.axis_px.x),
                 -metres_per_px * (last_row_px - optics.axis_px.y)};
  map.gradient.resize(grid.size());
  map.valid.assign(grid.size(), 0);
  if (has_sigma) map.sigma.assign(grid.size(), scale * largest_sigma);

  for (int row = 0; row < grid.rows; ++row) {
    for (int column = 0; column < grid.columns; ++column) {
      std::size_t const vector = grid.index(column, row), node = grid.index(column, grid.rows - 1 - row);
      if (!field.counts(vector)) {
        ++result.invalid;
        continue;
      }
      Vec2d const displacement = field.displacement_px[vector];
      map.valid[node] = 1;
      map.gradient[node] = {-scale * displacement.x, scale * displacement.y};
      if (!has_sigma) continue;
      Vec2d const sigma = field.sigma_px[vector];
      if (is_finite(sigma) && sigma.x > 0.0 && sigma.y > 0.0)
        map.sigma[node] = scale * sigma;
      else
        ++result.without_sigma;
    }
  }
  check_gradient_map(map);
  return result;
}

GradientMap compute_mean_gradient(GradientMap const& projected, double thickness) {
  if (!(thickness > 0.0) || !std::isfinite(thickness))
    throw SetupError({SetupProblem{"thickness", fmt::format("expected a positive number, got {}", thickness)}});
  GradientMap mean = projected;
  for (Vec2d& gradient : mean.gradient) gradient = gradient / thickness;
  for (Vec2d& sigma : mean.sigma) sigma = sigma / thickness;
  return mean;
}

}  // namespace gladstone::inline density
