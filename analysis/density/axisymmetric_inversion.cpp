#include "analysis/density/axisymmetric_inversion.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/density/density_methods.h"
#include "analysis/density/radial_profile.h"
#include "render/base/error.h"
#include "render/base/not_a_number.h"
#include "render/base/parallel.h"

namespace gladstone::inline density {
namespace {

void check_axisymmetric_settings(GradientMap const& map, AxisymmetricSettings const& settings) {
  std::vector<SetupProblem> problems;
  bool const regularized = abel_method(settings.method).regularized;
  double const first_vector = map.grid.origin.x,
               last_vector = first_vector + (map.grid.columns - 1) * map.grid.spacing.x;
  auto const [first, last] = settings.axis_range.value_or(std::array{first_vector, last_vector});
  if (settings.axis && !(*settings.axis >= first && *settings.axis <= last))
    problems.push_back({"axis", fmt::format("the axis at {:.4g} mm is outside the image ({:.4g} to {:.4g} mm); give a "
                                            "position inside, or none to find it",
                                            1e3 * *settings.axis, 1e3 * first, 1e3 * last)});
  if (regularized && settings.choice == RegularizationChoice::given &&
      !(settings.lambda > 0.0 && std::isfinite(settings.lambda)))
    problems.push_back({"lambda", fmt::format("expected a positive number, got {}", settings.lambda)});
  if (!std::isfinite(settings.ambient_density))
    problems.push_back({"ambient_density", fmt::format("expected a finite density, got {}", settings.ambient_density)});
  if (!problems.empty()) throw SetupError(problems);
  if (regularized && settings.choice == RegularizationChoice::discrepancy && map.sigma.empty())
    throw DataError(ErrorCode::missing_content, "density gradient",
                    "the discrepancy principle requires the uncertainty of the vectors (none is given); use "
                    "cross-validation, or give lambda");
}

/// Returns the index of the smallest radius at which a row determines the density. Without regularisation, all radii
/// from it to RadialProfile::last_measured() must be measured; with regularisation, it is the smallest measured radius.
int find_first_radius(RadialProfile const& profile, bool regularized) {
  int const last = profile.last_measured();
  int first = last;
  if (regularized)
    for (first = 1; first < last && !std::isfinite(profile.gradient[first]);) ++first;
  else
    while (first > 0 && std::isfinite(profile.gradient[first - 1])) --first;
  return first == 1 ? 0 : first;  // on the axis the gradient is known to be 0
}

/// Computes the standard uncertainties of linear combinations of one row's vectors, with the correlation of overlapping
/// windows.
/// @param weights  coefficients of the linear combinations [radii, columns]
Eigen::VectorXd propagate_row(Eigen::MatrixXd const& weights, GradientMap const& map, int row, double window) {
  Eigen::Index const columns = weights.cols();
  Eigen::MatrixXd scaled = weights;
  for (Eigen::Index i = 0; i < columns; ++i) scaled.col(i) *= map.sigma[map.grid.index(static_cast<int>(i), row)].x;
  Eigen::VectorXd variance = scaled.rowwise().squaredNorm();
  for (Eigen::Index lag = 1; lag < std::min<double>(columns, window); ++lag) {
    double const correlation = 1.0 - static_cast<double>(lag) / window;
    variance += 2.0 * correlation *
                scaled.leftCols(columns - lag).cwiseProduct(scaled.rightCols(columns - lag)).rowwise().sum();
  }
  return variance.cwiseMax(0.0).cwiseSqrt();
}

/// Returns the rms of the even part of the gradient about the axis, relative to the rms of the odd part; NaN if the odd
/// part is 0.
double compute_asymmetry(std::vector<RadialProfile> const& profiles) {
  double odd = 0.0, even = 0.0;
  for (RadialProfile const& profile : profiles) {
    odd += profile.odd_square;
    even += profile.even_square;
  }
  return odd > 0.0 ? std::sqrt(even / odd) : not_a_number;
}

/// Throws DataError if the gradients at equal distances on both sides of the axis do not have opposite signs. This is
/// the case if the odd part of the gradients does not dominate, and the sum of their products is not negative by more
/// than three times the scatter that it has for independent gradients.
void require_opposite_sides(std::vector<RadialProfile> const& profiles, double axis, bool is_given) {
  double odd = 0.0, even = 0.0, product_squares = 0.0;
  for (RadialProfile const& profile : profiles) {
    odd += profile.odd_square;
    even += profile.even_square;
    product_squares += profile.product_square;
  }
  bool const has_both_sides = product_squares > 0.0;
  if (!has_both_sides || odd > 2.0 * even || odd - even > 3.0 * std::sqrt(product_squares)) return;
  throw DataError(ErrorCode::inconsistent, "axis",
                  fmt::format("the flow is not symmetric about the axis at {:.4g} mm, {} (the gradients on its "
                              "sides are not opposite); {}, or subtract a displacement that all vectors have in "
                              "common",
                              1e3 * axis, is_given ? "which was given" : "which was found",
                              is_given ? "correct the axis" : "give the axis"));
}

/// Returns the rms of the gradient in the outer 5 % of the measured radii of each row, relative to that of all radii,
/// after subtraction of the part that its uncertainty explains; NaN if the gradient does not exceed its uncertainty.
double compute_border_gradient(std::vector<RadialProfile> const& profiles, bool has_sigma) {
  double all = 0.0, border = 0.0, count_all = 0.0, count_border = 0.0;
  for (RadialProfile const& profile : profiles) {
    int const last = profile.last_measured();
    for (int i = 1; i <= last; ++i) {
      double const noise = has_sigma ? profile.sigma[i] : 0.0;
      double const square = profile.gradient[i] * profile.gradient[i] - noise * noise;
      if (!std::isfinite(square)) continue;
      all += square;
      count_all += 1.0;
      if (i < 0.95 * last) continue;
      border += square;
      count_border += 1.0;
    }
  }
  return all > 0.0 ? std::sqrt(std::max(0.0, border / count_border) / (all / count_all)) : not_a_number;
}

}  // namespace

AxisymmetricDensity invert_axisymmetric(GradientMap const& projected, AxisymmetricSettings const& settings) {
  check_gradient_map(projected);
  if (settings.direction == AxisDirection::horizontal) {
    AxisymmetricSettings vertical = settings;
    vertical.direction = AxisDirection::vertical;
    vertical.overlap = {settings.overlap.y, settings.overlap.x};
    return invert_axisymmetric(transpose_map(projected), vertical);
  }
  check_axisymmetric_settings(projected, settings);
  check_window_overlap(projected.grid.columns, projected.grid.rows, settings.overlap);

  // Fold all rows about the axis
  AxisymmetricDensity result;
  result.axis = settings.axis ? SymmetryAxis{*settings.axis, not_a_number}
                              : find_symmetry_axis(projected, AxisDirection::vertical, settings.overlap);
  int const radii = count_radii(projected.grid, result.axis.position), rows = projected.grid.rows;
  if (radii < 4)
    throw DataError(ErrorCode::undetermined, "density gradient",
                    fmt::format("{} radii from the axis to the border are too few for an Abel "
                                "inversion (at least 4); use smaller windows or more overlap",
                                radii));
  std::vector<RadialProfile> profiles(static_cast<std::size_t>(rows));
  parallel_for(profiles.size(), [&](std::size_t row) {
    profiles[row] = fold_row(projected, static_cast<int>(row), result.axis.position);
  });
  if (std::none_of(profiles.begin(), profiles.end(), [](RadialProfile const& row) { return row.is_measured(); }))
    throw DataError(ErrorCode::undetermined, "density gradient",
                    "no valid vector lies on a radius; check the mask and the axis of symmetry");
  require_opposite_sides(profiles, result.axis.position, settings.axis.has_value());
  result.asymmetry = compute_asymmetry(profiles);
  result.border_gradient = compute_border_gradient(profiles, !projected.sigma.empty());

  // Invert row by row
  AbelMethod const& method = abel_method(settings.method);
  AbelInversion const prepared = method.prepare(radii, profiles, settings);
  result.lambda = prepared.lambda;
  result.grid = {radii, rows, {0.0, projected.grid.origin.y}, projected.grid.spacing};
  result.density.assign(result.grid.size(), not_a_number);
  result.sigma.assign(result.grid.size(), not_a_number);
  parallel_for(profiles.size(), [&](std::size_t r) {
    RadialProfile const& profile = profiles[r];
    if (!profile.is_measured()) return;
    int const row = static_cast<int>(r), first = find_first_radius(profile, method.regularized);
    Eigen::MatrixXd const inversion = prepared.matrix(profile);
    Eigen::VectorXd const excess = inversion * profile.filled_gradient();
    Eigen::VectorXd const sigma = projected.sigma.empty()
                                      ? Eigen::VectorXd::Constant(radii, not_a_number)
                                      : propagate_row(inversion * profile.fold, projected, row, settings.overlap.x);
    for (int i = first; i <= profile.last_measured(); ++i) {
      result.density[result.grid.index(i, row)] = settings.ambient_density + excess[i];
      result.sigma[result.grid.index(i, row)] = sigma[i];
    }
  });
  return result;
}

}  // namespace gladstone::inline density
