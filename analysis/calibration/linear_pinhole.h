#pragma once

#include "analysis/calibration/pinhole_fit.h"

namespace gladstone::inline calibration {

/// Computes a pinhole camera without distortion by the direct linear transformation (Hartley & Zisserman 2004, section
/// 7.1, with their normalisation), as the initial value of a fit. The transformation also yields a skew, which is set
/// to zero.
PinholeCamera linear_pinhole(CalibrationPoints const& points);

/// Returns the rms residual per component of the direct linear transformation with its skew retained [px].
double linear_residual_px(CalibrationPoints const& points);

/// Returns true if all points are on one plane: the smallest eigenvalue of their scatter matrix is below 1e-12 times
/// the largest.
bool on_one_plane(CalibrationPoints const& points);

}  // namespace gladstone::inline calibration
