#pragma once

#include "analysis/calibration/pinhole_fit.h"

namespace gladstone {

/// The pinhole camera without distortion that the direct linear transformation gives (Hartley & Zisserman 2004, section
/// 7.1, with their normalisation): the start of a fit. Skew, which the transformation allows, is dropped.
PinholeCamera linear_pinhole(CalibrationPoints const& points);

/// Residuals of the direct linear transformation itself, skew included: rms per component [px].
double linear_residual_px(CalibrationPoints const& points);

/// Whether all points lie on one plane: their least extent is nothing beside the largest.
bool on_one_plane(CalibrationPoints const& points);

}  // namespace gladstone
