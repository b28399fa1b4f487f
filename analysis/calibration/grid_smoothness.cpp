#include "analysis/calibration/grid_smoothness.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>

#include "render/base/median.h"

namespace gladstone::inline calibration {
namespace {

constexpr std::size_t least_for_cubic = 30, least_dots = 15;
constexpr double deviations = 6;           // residual above which a spot is removed, in robust standard deviations
constexpr double least_of_spacing = 0.02;  // minimum position residual of a removed spot, relative to the spacing
// minimum diameter residual of a removed spot, relative to the median diameter
constexpr double least_of_diameter = 0.25;
constexpr double least_diameter_px = 1;
constexpr int most_rounds = 20;

/// Returns the design matrix: products of powers of i and j up to a total order, both divided by the largest |i| or
/// |j|.
Eigen::MatrixXd make_design_matrix(std::vector<GridDot> const& dots, int order) {
  int most = 1;
  for (GridDot const& dot : dots) most = std::max({most, std::abs(dot.i), std::abs(dot.j)});
  Eigen::MatrixXd terms(static_cast<Eigen::Index>(dots.size()), (order + 1) * (order + 2) / 2);
  for (Eigen::Index row = 0; row < terms.rows(); ++row) {
    GridDot const& dot = dots[static_cast<std::size_t>(row)];
    double const u = static_cast<double>(dot.i) / most, v = static_cast<double>(dot.j) / most;
    Eigen::Index column = 0;
    for (int of_u = 0; of_u <= order; ++of_u) {
      for (int of_v = 0; of_u + of_v <= order; ++of_v) terms(row, column++) = std::pow(u, of_u) * std::pow(v, of_v);
    }
  }
  return terms;
}

/// Returns the residuals of each column of values from a polynomial in (i, j).
Eigen::MatrixXd compute_residuals(std::vector<GridDot> const& dots, Eigen::MatrixXd const& values, int order) {
  Eigen::MatrixXd const terms = make_design_matrix(dots, order);
  return values - terms * Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(terms).solve(values);
}

double median_of(Eigen::VectorXd const& values) { return upper_median({values.data(), values.data() + values.size()}); }

int choose_order(std::size_t dots) { return dots >= least_for_cubic ? 3 : 2; }

Eigen::MatrixXd places_of(std::vector<GridDot> const& dots) {
  Eigen::MatrixXd places(static_cast<Eigen::Index>(dots.size()), 2);
  for (std::size_t k = 0; k < dots.size(); ++k)
    places.row(static_cast<Eigen::Index>(k)) << dots[k].pixel.x, dots[k].pixel.y;
  return places;
}

Eigen::MatrixXd diameters_of(std::vector<GridDot> const& dots) {
  Eigen::MatrixXd diameters(static_cast<Eigen::Index>(dots.size()), 1);
  for (std::size_t k = 0; k < dots.size(); ++k) diameters(static_cast<Eigen::Index>(k), 0) = dots[k].diameter_px;
  return diameters;
}

/// Returns the image distance between neighbouring dots along the grid axis where this distance is shorter, from a
/// linear fit [px].
double estimate_spacing(std::vector<GridDot> const& dots) {
  Eigen::MatrixXd const terms = make_design_matrix(dots, 1), places = places_of(dots);
  Eigen::MatrixXd const map = Eigen::ColPivHouseholderQR<Eigen::MatrixXd>(terms).solve(places);
  int most = 1;
  for (GridDot const& dot : dots) most = std::max({most, std::abs(dot.i), std::abs(dot.j)});
  return std::min(map.row(1).norm(), map.row(2).norm()) / most;
}

/// Removes the dots whose residual exceeds both the limit and half the largest residual. Smaller residuals are not
/// judged yet, because the large outliers may have distorted the fit.
/// @return true if any dot was removed
bool remove_larger(SmoothGrid& grid, Eigen::VectorXd const& size, double limit) {
  double const largest = size.maxCoeff();
  if (!(largest > limit)) return false;
  std::vector<GridDot> kept;
  for (std::size_t k = 0; k < grid.dots.size(); ++k) {
    bool const stranger = size(static_cast<Eigen::Index>(k)) > std::max(limit, 0.5 * largest);
    if (stranger) grid.strangers.push_back(grid.dots[k].pixel);
    if (!stranger) kept.push_back(grid.dots[k]);
  }
  grid.dots = std::move(kept);
  return true;
}

bool remove_misplaced(SmoothGrid& grid) {
  Eigen::VectorXd const size =
      compute_residuals(grid.dots, places_of(grid.dots), choose_order(grid.dots.size())).rowwise().norm();
  double const deviation = median_of(size) / 1.1774;  // median of a Rayleigh distribution of unit scale
  return remove_larger(grid, size, std::max(deviations * deviation, least_of_spacing * estimate_spacing(grid.dots)));
}

bool remove_missized(SmoothGrid& grid) {
  Eigen::MatrixXd const diameters = diameters_of(grid.dots);
  Eigen::VectorXd const size = compute_residuals(grid.dots, diameters, 1).cwiseAbs().rowwise().norm();
  double const least = std::max(least_of_diameter * median_of(diameters.col(0)), least_diameter_px);
  return remove_larger(grid, size, std::max(deviations * sigma_per_median_deviation * median_of(size), least));
}

}  // namespace

SmoothGrid remove_inconsistent_spots(std::vector<GridDot> dots) {
  SmoothGrid grid{std::move(dots), {}, 0};
  for (int round = 0; round < most_rounds && grid.dots.size() >= least_dots; ++round) {
    if (!remove_missized(grid) && !remove_misplaced(grid)) break;
  }
  if (grid.dots.size() < least_dots) return grid;
  int const order = choose_order(grid.dots.size());
  Eigen::MatrixXd const residuals = compute_residuals(grid.dots, places_of(grid.dots), order);
  Eigen::Index const coefficients = (order + 1) * (order + 2) / 2;
  auto const freedom = static_cast<double>(2 * (residuals.rows() - coefficients));
  grid.rms_px = std::sqrt(residuals.squaredNorm() / freedom);
  return grid;
}

}  // namespace gladstone::inline calibration
