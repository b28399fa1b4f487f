#pragma once

#include "studies/compare/tomography.h"
#include "studies/drawing/figure.h"

namespace gladstone::inline figures {

/// The density in the plane y = const through the middle of the volume, which contains all directions of view:
/// truth, reconstruction and their difference, or only the reconstruction if the truth is unknown; over x and z in mm.
Figure make_tomography_figure(Tomography const& result);

}  // namespace gladstone::inline figures
