#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "analysis/density/line_differences.h"
#include "analysis/density/radial_profile.h"

namespace gladstone::inline density {

struct AxisymmetricSettings;

/// Method of a DensityIntegrator: minimises the sum over all pairs of neighbouring nodes of weight (density difference
/// - line integral of the gradient)^2.
struct IntegrationMethod {
  char const* name;
  char const* meaning;           ///< explanation of the method in the help of commands
  std::optional<EdgeRule> rule;  ///< quadrature rule of the line integrals; nullopt: IntegrationSettings::rule
  double (*weight)(LineDifference const& difference, GradientMap const& map);
};

/// Inversion of the rows of a gradient map.
struct AbelInversion {
  double lambda = 0.0;  ///< regularisation parameter [1]; 0: none
  /// Returns the matrix [radii, radii] from the gradient of a row to its density.
  std::function<Eigen::MatrixXd(RadialProfile const&)> matrix;
};

/// Method of an Abel inversion.
struct AbelMethod {
  char const* name;
  char const* meaning;  ///< explanation of the method in the help of commands
  /// Whether it has a regularisation parameter, and determines the density also at radii without a gradient.
  bool regularized;
  AbelInversion (*prepare)(int radii, std::vector<RadialProfile> const& profiles, AxisymmetricSettings const& settings);
};

/// Return all methods. The first one is the default.
std::span<IntegrationMethod const> integration_methods();
std::span<AbelMethod const> abel_methods();

/// Return the method of a name. @pre it exists
IntegrationMethod const& integration_method(std::string const& name);
AbelMethod const& abel_method(std::string const& name);

/// Returns the names of methods.
template <class Method>
std::vector<std::string> method_names(std::span<Method const> methods) {
  std::vector<std::string> names;
  for (Method const& method : methods) names.emplace_back(method.name);
  return names;
}

}  // namespace gladstone::inline density
