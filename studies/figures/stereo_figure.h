#pragma once

#include <string>

#include "studies/compare/stereo.h"

namespace gladstone {

/// Draws maps of the three components, of the residual, and for a rendered case of the errors, over x and y in mm.
/// Nodes without a value are grey.
/// @throws GnuplotMissing, OutputError
void write_stereo_figure(std::string const& path, StereoMeasurement const& measurement);

}  // namespace gladstone
