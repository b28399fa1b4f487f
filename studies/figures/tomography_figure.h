#pragma once

#include <string>

#include "studies/compare/tomography.h"

namespace gladstone {

/// Draws the density in the plane y = const through the middle of the volume, which contains all directions of view:
/// truth, reconstruction and their difference, or only the reconstruction if the truth is unknown; over x and z in mm.
/// @throws GnuplotMissing, OutputError
void write_tomography_figure(std::string const& path, Tomography const& result);

}  // namespace gladstone
