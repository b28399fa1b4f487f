#include "studies/figures/density_figure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "render/base/not_a_number.h"
#include "studies/figures/map_panels.h"

namespace gladstone::inline figures {
namespace {

using namespace plot;

/// Converts a field with rows upwards to a map with rows downwards.
Image<double> make_map(density::PlaneGrid const& grid, std::vector<double> const& values) {
  Image<double> map(grid.columns, grid.rows);
  for (int row = 0; row < grid.rows; ++row)
    for (int column = 0; column < grid.columns; ++column)
      map(column, grid.rows - 1 - row) = values[grid.index(column, row)];
  return map;
}

bool has_finite(std::vector<double> const& values) {
  return std::any_of(values.begin(), values.end(), [](double value) { return std::isfinite(value); });
}

/// Line of nodes through the largest deviation from the reference density.
struct DensityProfile {
  bool is_column = false;                           ///< true: profile over y; false: over x
  double at_mm = 0.0;                               ///< y of a row, x of a column [mm]
  std::vector<double> place_mm;                     ///< positions along the line [mm]
  std::vector<double> density, low, high, truth;    ///< density, its interval of +- sigma, and truth [kg/m^3]
  double largest_mm = 0.0, largest = not_a_number;  ///< position and density of the largest deviation
  double largest_sigma = not_a_number;              ///< standard uncertainty at the position of the largest deviation
                                                    ///< [kg/m^3]
};

/// Returns the index of the node with the largest deviation; 0 if no node has a density.
std::size_t find_largest_deviation(Reconstruction const& reconstruction) {
  std::size_t largest = 0;
  double deviation = -1.0;
  for (std::size_t i = 0; i < reconstruction.density.size(); ++i) {
    double const here = std::abs(reconstruction.density[i] - reconstruction.reference_density);
    if (!(here > deviation)) continue;
    deviation = here;
    largest = i;
  }
  return largest;
}

DensityProfile extract_profile(Reconstruction const& reconstruction) {
  density::PlaneGrid const& grid = reconstruction.grid;
  std::size_t const largest = find_largest_deviation(reconstruction);
  int const column = static_cast<int>(largest) % grid.columns, row = static_cast<int>(largest) / grid.columns;
  DensityProfile profile;
  profile.is_column =
      reconstruction.axisymmetry && reconstruction.axisymmetry->direction == density::AxisDirection::horizontal;
  Vec2d const through = grid.position(column, row);
  profile.at_mm = 1e3 * (profile.is_column ? through.x : through.y);
  profile.largest_mm = 1e3 * (profile.is_column ? through.y : through.x);
  profile.largest = reconstruction.density[largest];
  profile.largest_sigma = reconstruction.sigma[largest];
  for (int k = 0; k < (profile.is_column ? grid.rows : grid.columns); ++k) {
    int const i = profile.is_column ? column : k, j = profile.is_column ? k : row;
    std::size_t const node = grid.index(i, j);
    Vec2d const place = grid.position(i, j);
    double const density = reconstruction.density[node], sigma = reconstruction.sigma[node];
    profile.place_mm.push_back(1e3 * (profile.is_column ? place.y : place.x));
    profile.density.push_back(density);
    profile.low.push_back(density - sigma);
    profile.high.push_back(density + sigma);
    profile.truth.push_back(reconstruction.truth.empty() ? not_a_number : reconstruction.truth[node]);
  }
  return profile;
}

}  // namespace

Figure make_density_figure(Reconstruction const& reconstruction) {
  density::PlaneGrid const& grid = reconstruction.grid;
  Vec2d const top = grid.position(0, grid.rows - 1);
  MapFigure figure;
  figure.title = reconstruction.axisymmetry ? "Density in the plane through the axis"
                                            : "Density, mean over the thickness of the medium";
  figure.axes = {1e3 * top.x, 1e3 * grid.spacing.x, 1e3 * top.y, -1e3 * grid.spacing.y, false, "x [mm]", "y [mm]"};
  bool const has_truth = !reconstruction.truth.empty();
  bool const has_sigma = has_finite(reconstruction.sigma);
  figure.panels.push_back(
      {"ρ [kg/m³]", make_map(grid, reconstruction.density), ColourScale::sequential, has_truth ? "density" : ""});
  if (has_truth)
    figure.panels.push_back(
        {"true ρ [kg/m³]", make_map(grid, reconstruction.truth), ColourScale::sequential, "density"});
  if (has_sigma)
    figure.panels.push_back(
        {"standard uncertainty of ρ [kg/m³]", make_map(grid, reconstruction.sigma), ColourScale::magnitude});
  if (has_truth) {
    std::vector<double> error(reconstruction.density);
    for (std::size_t i = 0; i < error.size(); ++i) error[i] -= reconstruction.truth[i];
    figure.panels.push_back({"error of ρ [kg/m³]", make_map(grid, error), ColourScale::diverging});
  }
  figure.columns = std::min<int>(2, static_cast<int>(figure.panels.size()));
  return make_map_figure(figure);
}

Figure make_density_profile(Reconstruction const& reconstruction) {
  DensityProfile const profile = extract_profile(reconstruction);
  Figure figure{820, 460};
  figure.add_title(fmt::format("Density at {} = {:.3f} mm", profile.is_column ? "x" : "y", profile.at_mm));
  Panel panel{.box = {96, 790, 60, 400}};
  panel.x.label = profile.is_column ? "y [mm]" : "x [mm]";
  panel.y.label = "density [kg/m³]";
  panel.grid = Grid::both;
  panel.legend.place = LegendPlace::top_right;
  if (!has_finite(profile.density)) {
    panel.x.low = panel.y.low = 0;
    panel.x.high = panel.y.high = 1;
    panel.labels.push_back({"no density is known", 0.5, 0.5});
  } else if (has_finite(profile.high)) {
    panel.layers.push_back({Layer::Kind::band,
                            {profile.place_mm, profile.low, profile.high},
                            house_colour(0),
                            "one standard uncertainty"});
    panel.layers.back().opacity = 0.25;
  }
  if (has_finite(profile.density)) {
    panel.layers.push_back(
        {.columns = {profile.place_mm, profile.density}, .colour = house_colour(0), .name = "reconstructed"});
  }
  if (has_finite(profile.truth)) {
    panel.layers.push_back({.columns = {profile.place_mm, profile.truth},
                            .colour = house_colour(1),
                            .name = "true",
                            .dash = Dash::dashed});
  }
  figure.panels.push_back(std::move(panel));
  return figure;
}

std::string describe_density_profile(Reconstruction const& reconstruction) {
  DensityProfile const profile = extract_profile(reconstruction);
  std::string const sigma =
      std::isfinite(profile.largest_sigma) ? fmt::format(" +- {:.3g}", profile.largest_sigma) : "";
  return fmt::format(
      "Density with its standard uncertainty at {} = {:.4g} mm, through the largest deviation from the reference of "
      "{:.5g} kg/m^3: {:.5g}{} kg/m^3 at {} = {:.4g} mm.",
      profile.is_column ? "x" : "y", profile.at_mm, reconstruction.reference_density, profile.largest, sigma,
      profile.is_column ? "y" : "x", profile.largest_mm);
}

}  // namespace gladstone::inline figures
