#pragma once

#include <array>
#include <vector>

#include "analysis/calibration/calibration_points.h"

namespace gladstone {

/// Pixel as a polynomial of the place in the world: cubic in X and Y, quadratic in Z, 19 terms a component (Soloff,
/// Adrian & Liu, Meas. Sci. Technol. 8 (1997) 1441, eq. 21). It asks for no optics and so holds through windows and
/// lenses of any kind, but only where there were dots. From two planes the terms with Z^2 are left out.
struct SoloffPolynomial {
  std::vector<std::array<int, 3>> exponents;  ///< of X, Y, Z
  std::vector<Vec2d> coefficients;            ///< [px / m^sum of exponents]

  Vec2d image_of_dot(Vec3d centre, double radius) const;
};

struct SoloffFit {
  SoloffPolynomial polynomial;
  std::vector<Vec2d> standard_error;  ///< of the coefficients
  std::vector<Vec2d> residual_px;     ///< seen minus fitted
  double rms_px = 0;                  ///< of the residuals, per component
};

/// Fits the coefficients by linear least squares.
/// @throws std::invalid_argument where the points are fewer than the terms, or leave a term open: too few columns, rows
///         or planes of dots
SoloffFit fit_soloff(CalibrationPoints const& points);

}  // namespace gladstone
