#pragma once

#include <Eigen/Core>

#include "analysis/density/gradient_map.h"

namespace gladstone::inline density {

/// Radial profile of the gradient across a vertical axis in one row, combined from both sides of the axis.
struct RadialProfile {
  /// Odd part (g(axis + r) - g(axis - r))/2 at r = i spacing [radii]; NaN: no side is valid.
  Eigen::VectorXd gradient;
  Eigen::VectorXd sigma;  ///< standard uncertainty for independent vectors, in the unit of the gradient (1
                          ///< without sigma) [radii]
  /// Matrix that folds the row: gradient = fold times the row's gradients [radii, columns].
  Eigen::MatrixXd fold;
  double odd_square = 0.0;  ///< sum of squares of the folded gradient over the radii at which both sides are valid
  /// Sum of squares of the even part (g(axis + r) + g(axis - r))/2 over the radii at which both sides are valid.
  double even_square = 0.0;
  /// Sum of squares of g(axis + r) g(axis - r) over the radii at which both sides are valid.
  double product_square = 0.0;

  /// Returns true if at least one radius besides the axis has a measured gradient.
  bool is_measured() const { return last_measured() > 0; }
  /// Returns the index of the largest radius with a measured gradient; 0 if there is none besides the axis.
  int last_measured() const;
  /// Returns the gradient, with 0 in place of NaN at radii without a measurement [radii].
  Eigen::VectorXd filled_gradient() const { return gradient.array().isFinite().select(gradient.array(), 0.0); }
};

/// Returns the number of radii from the axis to the farther border of the grid.
int count_radii(PlaneGrid const& grid, double axis);

/// Folds one row about the axis. Each side is interpolated by the cubic through four valid nodes (linearly next to
/// holes), and the sides are weighted with their inverse variances. The gradient on the axis is zero.
/// @param axis  x of the axis, inside or outside the grid [m]
RadialProfile fold_row(GradientMap const& map, int row, double axis);

}  // namespace gladstone::inline density
