#pragma once

#include <string>

#include "studies/compare/reconstruct.h"

namespace gladstone {

/// Draws maps of the density and its standard uncertainty, and for a rendered case of the true density and the error,
/// over x and y in mm. Nodes without a value are grey.
/// @throws GnuplotMissing, OutputError
void write_density_figure(std::string const& path, Reconstruction const& reconstruction);

}  // namespace gladstone
