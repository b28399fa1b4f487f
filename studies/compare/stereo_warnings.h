#pragma once

#include "render/base/warning.h"
#include "studies/compare/stereo.h"

namespace gladstone::inline compare {

/// Returns warnings about a measurement of three components: a small angle between the views, a displaced laser sheet,
/// rejected vectors, missing uncertainty, and disagreement of the cameras.
Warnings find_stereo_warnings(StereoMeasurement const& measurement);

}  // namespace gladstone::inline compare
