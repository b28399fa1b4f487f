#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "analysis/vectors/displacement_field.h"
#include "studies/design/design_point.h"
#include "studies/drawing/figure.h"

namespace gladstone::inline report {

/// Density gradients at measured vectors with their uncertainties; components along X and Y of the world.
struct MeasuredGradients {
  std::vector<Vec2d> gradient;  ///< density gradient; NaN at invalid vectors [kg/m^4]
  std::vector<Vec2d> random;    ///< standard uncertainty from the displacement [kg/m^4]
  std::vector<Vec2d> combined;  ///< standard uncertainty including that of the setup's parameters [kg/m^4]
  /// number of vectors with an uncertainty by the estimator; for the others it is computed by formula
  std::size_t estimated = 0;
  double common = 0;      ///< relative uncertainty from the setup's parameters [1]
  std::size_t count = 0;  ///< number of valid vectors
};

/// Computes gradients and uncertainties at the vectors of a field.
/// @param common  relative uncertainty from all parameters of the setup [1]
MeasuredGradients compute_gradients(DisplacementField const& field, DesignPoint<double> const& bench, double common);

/// Returns both components of all finite vectors.
std::vector<double> finite_components(std::vector<Vec2d> const& values);

/// Returns the root mean square; NaN for no values.
double compute_rms(std::vector<double> const& values);

/// Returns maps for the report, for vectors on a lattice: displacement, gradient, its combined uncertainty, and the
/// displacement's contribution.
std::vector<NamedFigure> make_measured_maps(DisplacementField const& field, MeasuredGradients const& all);

/// Draws displacement, gradient and its combined standard uncertainty on the lattice of the vectors.
/// @return path of the figure
std::string draw_measured_maps(std::string const& path, DisplacementField const& field, MeasuredGradients const& all);

}  // namespace gladstone::inline report
