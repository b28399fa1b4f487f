#include "studies/compare/density_warnings.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "render/base/not_a_number.h"

namespace gladstone::inline compare {

void warn_of_regions(Reconstruction& result, std::vector<density::Region> const& regions) {
  std::size_t without = 0, nodes = 0;
  density::Region const* largest = nullptr;
  for (density::Region const& region : regions) {
    if (region.reference_nodes > 0) continue;
    if (!largest) largest = &region;
    ++without;
    nodes += region.nodes;
  }
  if (without == 0) return;
  result.warnings.push_back(
      {WarningCode::incomplete, "reference",
       fmt::format(
           "{} of {} regions of valid vectors contain no reference density, so that {} vectors have no density; the "
           "largest has {}; add --reference X0,Y0,X1,Y1 within it if its density is known somewhere",
           without, regions.size(), nodes, describe_region(*largest))});
}

void warn_of_reference_gradient(Reconstruction& result) {
  constexpr double largest_ratio = 0.4;
  Vec2d sum;
  double squares = 0;
  std::size_t inside = 0, valid = 0;
  for (std::size_t i = 0; i < result.gradient.size(); ++i) {
    Vec2d const gradient = result.gradient[i];
    if (!std::isfinite(gradient.x)) continue;
    squares += dot(gradient, gradient);
    ++valid;
    if (result.reference[i] == 0) continue;
    sum = sum + gradient;
    ++inside;
  }
  if (inside == 0 || !(squares > 0)) return;
  if (inside == valid) {
    result.warnings.push_back({WarningCode::unsuitable, "reference",
                               "the reference region contains all vectors, so that the density is the reference "
                               "density everywhere; choose a region outside the flow"});
    return;
  }
  double const ratio = length(sum) / static_cast<double>(inside) / std::sqrt(squares / static_cast<double>(valid));
  if (ratio < largest_ratio) return;
  result.warnings.push_back(
      {WarningCode::unsuitable, "reference",
       fmt::format(
           "the mean gradient in the reference region is {:.0f} % of the rms gradient of all vectors: the flow reaches "
           "into the region, so that the density has an offset; choose a side or a box outside the flow",
           100 * ratio)});
}

WindowEffect estimate_window_effect(Reconstruction const& result) {
  density::PlaneGrid const& grid = result.grid;
  auto const halve = [](double overlap) { return std::max(1, static_cast<int>(std::lround(0.5 * overlap))); };
  int const step_x = halve(result.overlap.x), step_y = halve(result.overlap.y);
  double const weight_x = std::pow(result.overlap.x / step_x, 2) / 24.0,
               weight_y = std::pow(result.overlap.y / step_y, 2) / 24.0;
  double changes = 0.0, variances = 0.0, count = 0.0;
  for (int row = step_y; row + step_y < grid.rows; ++row)
    for (int column = step_x; column + step_x < grid.columns; ++column) {
      auto const value = [&](int x, int y) { return result.density[grid.index(column + x, row + y)]; };
      double const twice = 2.0 * value(0, 0), sigma = result.sigma[grid.index(column, row)];
      double const change = weight_x * (value(step_x, 0) + value(-step_x, 0) - twice) +
                            weight_y * (value(0, step_y) + value(0, -step_y) - twice);
      if (!std::isfinite(change) || !(sigma > 0.0)) continue;
      changes += change * change;
      variances += sigma * sigma;
      count += 1.0;
    }
  return count > 0.0 ? WindowEffect{std::sqrt(changes / count), std::sqrt(variances / count)} : WindowEffect{};
}

void warn_of_window(Reconstruction& result) {
  WindowEffect const effect = estimate_window_effect(result);
  if (!(effect.change > effect.sigma)) return;
  result.warnings.push_back(
      {WarningCode::low_accuracy, "correlate.window_px",
       fmt::format(
           "the averaging over the interrogation windows changes the density by about {:.2g} kg/m^3 rms, {:.2g} times "
           "the standard uncertainty, which does not contain it; use smaller windows, or a larger magnification",
           effect.change, effect.change / effect.sigma)});
}

double compute_displacement_gradient(density::GradientMap const& projected, density::ProjectionOptics const& optics) {
  density::PlaneGrid const& grid = projected.grid;
  double sum = 0.0, count = 0.0;
  for (int row = 1; row + 1 < grid.rows; ++row)
    for (int column = 1; column + 1 < grid.columns; ++column) {
      if (!projected.is_valid(column - 1, row) || !projected.is_valid(column + 1, row) ||
          !projected.is_valid(column, row - 1) || !projected.is_valid(column, row + 1))
        continue;
      auto const& gradient = projected.gradient;
      Vec2d const by_x =
          (gradient[grid.index(column + 1, row)] - gradient[grid.index(column - 1, row)]) / (2.0 * grid.spacing.x);
      Vec2d const by_y =
          (gradient[grid.index(column, row + 1)] - gradient[grid.index(column, row - 1)]) / (2.0 * grid.spacing.y);
      double const divergence = by_x.x + by_y.y, curl = by_x.y - by_y.x;
      sum += divergence * divergence - curl * curl;
      count += 1.0;
    }
  double const px_per_m = optics.medium_magnification() / optics.pixel_pitch;
  return count > 0.0 ? optics.sensitivity() / px_per_m * std::sqrt(std::max(0.0, sum / count)) : not_a_number;
}

void warn_of_displacement_gradient(Reconstruction& result, density::GradientMap const& projected,
                                   density::ProjectionOptics const& optics) {
  // Turbulence at f/11 to f/32 (docs/explained/equation-9.md): error of the density over this gradient
  constexpr double noticeable = 0.01, least_error = 1.2, largest_error = 8.0;
  double const gradient = compute_displacement_gradient(projected, optics);
  if (!(gradient > noticeable)) return;
  result.warnings.push_back(
      {WarningCode::low_accuracy, "geometry.z_d_mm",
       fmt::format(
           "the displacement changes by {:.2g} px per px (rms, without noise): rays cross other parts of the medium "
           "than Eq. 9 assumes; in turbulence this causes errors of {:.0f} to {:.0f} % of the density's "
           "variation, and the widest apertures have the largest; reduce Z_D",
           gradient, 100.0 * least_error * gradient, std::min(100.0, 100.0 * largest_error * gradient))});
}

}  // namespace gladstone::inline compare
