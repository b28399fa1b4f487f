#pragma once

#include <array>
#include <vector>

#include "analysis/calibration/calibration_points.h"

namespace gladstone::inline calibration {

/// Polynomial camera model: pixel position as a polynomial of the world position, cubic in X and Y and quadratic in Z,
/// 19 terms per component (Soloff, Adrian & Liu, Meas. Sci. Technol. 8 (1997) 1441, Eq. 21). The polynomial requires no
/// model of the optics and thus describes optical windows and arbitrary lenses, but it is valid only within the volume
/// of the dots. With two planes, the terms in Z^2 are omitted.
struct SoloffPolynomial {
  std::vector<std::array<int, 3>> exponents;  ///< exponents of X, Y, Z
  std::vector<Vec2d> coefficients;            ///< coefficients of the terms for column and row [px / m^(sum of the
                                              ///< exponents)]
};

struct SoloffFit {
  SoloffPolynomial polynomial;
  std::vector<Vec2d> standard_error;  ///< standard error of each coefficient
  std::vector<Vec2d> residual_px;     ///< measured minus fitted position
  double rms_px = 0;                  ///< rms of the residuals per component
};

/// Fits the coefficients by linear least squares.
/// @throws std::invalid_argument if there are not more points than terms, or a term is undetermined because of too few
///         columns, rows or planes of dots
SoloffFit fit_soloff(CalibrationPoints const& points);

}  // namespace gladstone::inline calibration
