#pragma once

#include <string>
#include <vector>

#include "analysis/correlation/interrogation_grid.h"
#include "analysis/correlation/window_deformation.h"
#include "analysis/correlation/window_measurement.h"
#include "analysis/correlation/window_ops.h"

namespace gladstone {

/// Correlates every window of a grid: weighted mean removed, weighted, cross-correlated by Fourier transform over a
/// square of twice the nominal window (so that shifts up to half a window never wrap), peaks by three-point Gaussian.
/// The fall-off of the plane with the shift that the weights cause is divided out before the fit, else it would pull
/// every peak towards zero. Windows go through the transform in pairs, and the pairs depend on the grid alone: the
/// result is the same for any number of threads.
/// @param search_radius_px largest shift looked for along either axis, at most half a window
/// @param label            of the progress bar
std::vector<WindowCorrelation> correlate_windows(ImagePair const& pair, InterrogationGrid const& grid,
                                                 WindowWeighting weighting, int search_radius_px,
                                                 std::string const& label);

}  // namespace gladstone
