#pragma once

#include "studies/compare/stereo.h"
#include "studies/drawing/figure.h"

namespace gladstone::inline figures {

/// Maps of the three components, of the residual, and for a rendered case of the errors, over x and y in mm.
/// Nodes without a value are grey.
Figure make_stereo_figure(StereoMeasurement const& measurement);

}  // namespace gladstone::inline figures
