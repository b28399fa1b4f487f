#pragma once

#include <string>
#include <vector>

#include "studies/compare/stereo.h"

namespace gladstone {

/// Returns warnings about a measurement of three components: a small angle between the views, a displaced laser sheet,
/// rejected vectors, missing uncertainty, and disagreement of the cameras.
std::vector<std::string> find_stereo_warnings(StereoMeasurement const& measurement);

}  // namespace gladstone
