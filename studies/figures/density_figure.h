#pragma once

#include <string>

#include "studies/compare/reconstruct.h"
#include "studies/drawing/figure.h"

namespace gladstone::inline figures {

/// Maps of the density and its standard uncertainty, and for a rendered case of the true density and the error,
/// over x and y in mm. Nodes without a value are grey.
Figure make_density_figure(Reconstruction const& reconstruction);

/// Profile of the density with its standard uncertainty as a band, and for a rendered case the true density:
/// the row of nodes through the largest deviation from the reference density, over x in mm, or for a flow with a
/// horizontal axis of symmetry the column, over y in mm.
Figure make_density_profile(Reconstruction const& reconstruction);

/// Describes the profile in numbers.
std::string describe_density_profile(Reconstruction const& reconstruction);

}  // namespace gladstone::inline figures
