#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "analysis/density/gradient_map.h"
#include "analysis/density/regularized_inversion.h"
#include "analysis/density/symmetry_axis.h"
#include "analysis/density/window_correlation.h"

namespace gladstone::inline density {

struct AxisymmetricSettings {
  AxisDirection direction = AxisDirection::vertical;
  std::optional<double> axis;  ///< x of a vertical, y of a horizontal axis [m]; nullopt: find_symmetry_axis()
  /// Range of a given axis: the borders of the image across it [m]; nullopt: the outermost vectors.
  std::optional<std::array<double, 2>> axis_range;
  std::string method = "direct";  ///< one of abel_methods()
  RegularizationChoice choice = RegularizationChoice::cross_validation;
  double lambda = 0.0;           ///< regularisation parameter for RegularizationChoice::given [1]
  WindowOverlap overlap;         ///< overlap of the interrogation windows, required for sigma
  double ambient_density = 0.0;  ///< density beyond the last radius, to which the result is referred [kg/m^3]
};

/// Density in a half plane through the axis of symmetry.
struct AxisymmetricDensity {
  PlaneGrid grid;               ///< x: radius from 0, y: position along the axis [m]
  std::vector<double> density;  ///< density [kg/m^3, grid.size()]; NaN: not determined
  /// Standard uncertainty propagated from the gradient [kg/m^3, grid.size()]; NaN: gradient without sigma. It excludes
  /// the uncertainties of the axis and of the ambient density, and the smoothing by the regularisation.
  std::vector<double> sigma;
  SymmetryAxis axis;    ///< position of the axis; its sigma is NaN if the user gave the axis
  double lambda = 0.0;  ///< regularisation parameter; 0: none
  /// Ratio of the rms of the even part of the gradient about the axis to the rms of its odd part [1]: 0 for an
  /// axisymmetric flow without noise.
  double asymmetry = 0.0;
  /// Ratio of the rms of the gradient in the outer 5 % of the measured radii of each row to its rms at all radii, both
  /// after subtraction of the part that sigma explains [1]. If the ratio is not small, the flow extends beyond the
  /// vectors, and the density is biased.
  double border_gradient = 0.0;
};

/// Inverts the projected gradient of an axisymmetric flow to density, row by row across the axis. A deflection is
/// already the derivative of the projection, so nothing is differentiated. Assumes parallel lines of sight and ambient
/// density beyond the largest measured radius of each row; one side of the axis suffices. With the direct method a hole
/// in the gradient leaves all smaller radii of its row undetermined.
/// @param projected  projected gradient, computed by compute_projected_gradient() [kg/m^3]
/// @throws SetupError  if the axis is outside its range, lambda is not positive (choice `given`), the ambient density
///                     is not finite, or the overlap does not fit the grid
/// @throws DataError   if the gradient is not odd about the axis, the discrepancy principle is chosen for a gradient
///                     without sigma, or no density can be determined; see also check_gradient_map() and
///                     find_symmetry_axis()
AxisymmetricDensity invert_axisymmetric(GradientMap const& projected, AxisymmetricSettings const& settings);

}  // namespace gladstone::inline density
