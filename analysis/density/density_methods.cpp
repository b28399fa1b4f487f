#include "analysis/density/density_methods.h"

#include <algorithm>
#include <array>
#include <utility>

#include "analysis/density/abel_operators.h"
#include "analysis/density/axisymmetric_inversion.h"
#include "render/base/contracts.h"

namespace gladstone::inline density {
namespace {

/// Weights a difference equation by the reciprocal of its variance: Rajendran, Zhang, Bane & Vlachos, Exp. Fluids 61
/// (2020) 239.
double weigh_by_variance(LineDifference const& difference, GradientMap const& map) {
  return 1.0 / compute_variance(difference, map.sigma);
}

/// Five-point Poisson equation with the divergence of the gradient by central differences and natural Neumann
/// boundaries, for comparison.
double weigh_by_cells(LineDifference const& difference, GradientMap const& map) {
  double const spacing = difference.axis == LineAxis::x ? map.grid.spacing.x : map.grid.spacing.y;
  return 0.5 * std::max(difference.cells, 1) / (spacing * spacing);
}

/// Table of the integration methods.
constexpr std::array integrations{
    IntegrationMethod{"wls", "weighted least squares", std::nullopt, weigh_by_variance},
    IntegrationMethod{"poisson", "no weights", EdgeRule::trapezoid, weigh_by_cells},
};

/// Largest number of rows from which the regularisation parameter is determined.
constexpr std::size_t regularization_rows = 8;

/// Determines lambda from rows spread over the map.
double determine_lambda(Eigen::MatrixXd const& projection, std::vector<RadialProfile> const& profiles,
                        AxisymmetricSettings const& settings) {
  if (settings.choice == RegularizationChoice::given) return settings.lambda;
  std::vector<std::size_t> measured;
  for (std::size_t row = 0; row < profiles.size(); ++row)
    if (profiles[row].is_measured()) measured.push_back(row);
  std::size_t const rows = measured.size(), count = std::min(rows, regularization_rows);
  std::vector<RadialProfile> chosen;
  for (std::size_t k = 0; k < count; ++k) chosen.push_back(profiles[measured[(2 * k + 1) * rows / (2 * count)]]);
  return choose_regularization(projection, chosen, settings.choice);
}

/// Prepares the fourth-order inversion of make_gradient_inversion(), whose noise increases towards the axis.
AbelInversion prepare_direct(int radii, std::vector<RadialProfile> const&, AxisymmetricSettings const&) {
  return {0.0, [inversion = make_gradient_inversion(radii)](RadialProfile const&) { return inversion; }};
}

/// make_regularized_inversion(): less noise where the vectors are much finer than the structures, but smooths. The
/// inversion of a gradient amplifies noise little, so the gain is small on coarse grids.
AbelInversion prepare_tikhonov(int radii, std::vector<RadialProfile> const& profiles,
                               AxisymmetricSettings const& settings) {
  Eigen::MatrixXd projection = make_gradient_projection(radii);
  double const lambda = determine_lambda(projection, profiles, settings);
  return {lambda, [projection = std::move(projection), lambda](RadialProfile const& profile) {
            return make_regularized_inversion(projection, profile, lambda);
          }};
}

/// Table of the Abel inversions.
constexpr std::array inversions{
    AbelMethod{"direct", "no regularisation", false, prepare_direct},
    AbelMethod{"tikhonov", "regularised", true, prepare_tikhonov},
};

template <class Methods>
auto const& find_method(Methods const& methods, std::string const& name) {
  auto const found =
      std::find_if(methods.begin(), methods.end(), [&name](auto const& row) { return name == row.name; });
  GLADSTONE_EXPECTS(found != methods.end());
  return *found;
}

}  // namespace

std::span<IntegrationMethod const> integration_methods() { return integrations; }
std::span<AbelMethod const> abel_methods() { return inversions; }

IntegrationMethod const& integration_method(std::string const& name) { return find_method(integrations, name); }
AbelMethod const& abel_method(std::string const& name) { return find_method(inversions, name); }

}  // namespace gladstone::inline density
